#include "core/store/motion_writer.h"

#include <utility>

#include "core/store/dataset_writer.h"

namespace mocurate::store {
namespace {

template <class T>
std::vector<T> RowOfValues(const std::vector<T>& values, std::size_t row, std::size_t width) {
  const auto begin = values.begin() + static_cast<std::ptrdiff_t>(row * width);
  return {begin, begin + static_cast<std::ptrdiff_t>(width)};
}

}  // namespace

Expected<MotionWriter> MotionWriter::Create(const Schema& schema, Content content, const std::vector<MotionRow>& rows,
                                            const Skeleton& skeleton, bool joints_only,
                                            const std::filesystem::path& path) {
  const Status packed = InFile(PackOutlines(rows, skeleton, joints_only, schema.prefix, content), path);
  if (!packed) return Forward(packed);
  Content rules;
  PackSkeleton(skeleton, schema.prefix, rules);
  rules.PutText("/@kinematics", joints_only ? "joints" : "tree");
  std::vector<double> bones, rest;
  if (!joints_only) bones = content.Values<double>(schema.prefix + "/clips/bone_length");
  if (content.Has(schema.prefix + "/clips/rest_offset")) {
    rest = content.Values<double>(schema.prefix + "/clips/rest_offset");
  }
  auto writer = ContentWriter::Create(schema, std::move(content), path);
  if (!writer) return Forward(writer);
  MotionWriter made(std::move(*writer), schema, path);
  made.joints_only_ = joints_only;
  made.rules_ = std::move(rules);
  made.bone_lengths_ = std::move(bones);
  made.rest_offsets_ = std::move(rest);
  for (const MotionRow& row : rows) {
    made.present_ |= row.optional_fields;
    made.rows_.push_back({row.id, row.motion->frame_count(), row.optional_fields});
  }
  return made;
}

Status MotionWriter::Append(const Motion& motion) {
  if (next_ == rows_.size()) {
    return Fail(ErrorCode::kInconsistent, "gets another motion after all " + std::to_string(next_),
                Where(path_, "/clips"));
  }
  const Announced& row = rows_[next_];
  const std::string place = Where(path_, row.id);
  if (motion.frame_count() != row.frames || OptionalFieldsOf(motion) != row.optional_fields) {
    return Fail(ErrorCode::kInconsistent,
                "the motion has " + std::to_string(motion.frame_count()) + " frames and optional fields " +
                    std::to_string(OptionalFieldsOf(motion)) + "; declared were " + std::to_string(row.frames) +
                    " and " + std::to_string(row.optional_fields),
                place);
  }
  if (Status checked = CheckFrames(row.id, motion, joints_only_); !checked) {
    checked.error().where = place;
    return checked;
  }
  const std::string& prefix = schema_->prefix;
  const std::uint64_t J = rules_.fields.at(prefix + "/skeleton/names").rows();
  Content one = rules_;
  PackFrames(motion, present_, joints_only_, prefix, one);
  one.Put(prefix + "/clips/offset", {1}, std::vector<std::int64_t>{0});
  one.Put(prefix + "/clips/count", {1}, std::vector<std::int64_t>{row.frames});
  if (!joints_only_) one.Put(prefix + "/clips/bone_length", {1, J}, RowOfValues(bone_lengths_, next_, J));
  if (!rest_offsets_.empty()) {
    one.Put(prefix + "/clips/rest_offset", {1, J, 3}, RowOfValues(rest_offsets_, next_, 3 * J));
  }
  const auto where = [this](const std::string& field) { return Where(path_, field); };
  const std::string frames = prefix + "/frames/";
  if (Status sound = CheckRulesBelow(frames, *schema_, one, ErrorCode::kInconsistent, where); !sound) {
    sound.error().what = "of clip '" + row.id + "': " + sound.error().what;
    return sound;
  }
  for (const auto& [path, array] : one.fields) {
    if (path.rfind(frames, 0) != 0) continue;
    if (Status written = writer_.Append(path, array); !written) return written;
  }
  ++next_;
  return {};
}

Status MotionWriter::Finish() {
  if (next_ < rows_.size()) {
    return Fail(ErrorCode::kInconsistent,
                "the motion is missing: " + std::to_string(next_) + " of " + std::to_string(rows_.size()) + " came",
                Where(path_, rows_[next_].id));
  }
  return writer_.Finish();
}

}  // namespace mocurate::store
