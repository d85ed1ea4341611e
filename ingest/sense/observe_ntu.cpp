#include <algorithm>
#include <cmath>
#include <map>

#include "core/base/file.h"
#include "core/base/text.h"
#include "core/formats/ntu_skeleton.h"
#include "ingest/sense/name_sense.h"
#include "ingest/sense/observe.h"
#include "ingest/sense/remark.h"
#include "ingest/sources/ntu_exchanged_ids.h"
#include "ingest/sources/ntu_people.h"

namespace mocurate {
namespace {

constexpr double kManyInferred = 0.3;  // share of a body's joints that the sensor guessed, worth a warning

const std::vector<std::string>& KinectJoints() {
  for (const JointOrder& order : KnownJointOrders()) {
    if (order.name == "kinect2") return order.joints;
  }
  static const std::vector<std::string> none;
  return none;
}

/// The frames of one body: missing where the sensor does not follow the joint, or the body is not there.
ObservedClip BodyClip(const NtuSkeleton& skeleton, std::uint64_t id) {
  ObservedClip clip;
  clip.format = "ntu_skeleton";
  clip.frames = static_cast<int>(skeleton.frames.size());
  clip.joints = kNtuJoints;
  clip.positions = JointPositions(clip.frames, clip.joints);
  clip.confidence.assign(static_cast<std::size_t>(clip.frames) * kNtuJoints, 0.0);
  int present = 0, inferred = 0;
  for (int f = 0; f < clip.frames; ++f) {
    for (const NtuBody& body : skeleton.frames[static_cast<std::size_t>(f)]) {
      if (body.id != id) continue;
      ++present;
      for (int j = 0; j < kNtuJoints; ++j) {
        const NtuJoint& joint = body.joints[static_cast<std::size_t>(j)];
        if (joint.tracking == 0) continue;
        if (joint.tracking == 1) ++inferred;
        clip.positions.at(f, j) = Vector3d(joint.x_m, joint.y_m, joint.z_m);
        clip.confidence[static_cast<std::size_t>(f) * kNtuJoints + static_cast<std::size_t>(j)] =
            joint.tracking == 1 ? 0.5 : 1.0;
      }
    }
  }
  clip.facts.emplace_back("body", std::to_string(id));
  clip.layout_evidence = "counts of the file; the body is in " + Counted(present, "frame");
  const double share = present == 0 ? 0.0 : static_cast<double>(inferred) / (present * kNtuJoints);
  if (inferred > 0) {
    clip.remarks.push_back({"inferred_joints", share > kManyInferred ? Severity::kWarning : Severity::kInfo, share,
                            "the sensor inferred " + FormatDouble(std::round(1000.0 * share) / 10.0) +
                                " % of the joints (tracking state 1) instead of seeing them"});
  }
  return clip;
}

/// Whom of the file a run of the source takes, and who is not there.
void ComparePeople(const NtuSkeleton& skeleton, const SourceOptions& source, const FileBytes& file,
                   std::vector<Remark>& remarks) {
  if (source.format != SourceFormat::kNtuSkeleton || source.views.together || !source.rate_hz) return;
  Expected<NamedFile> named = ReadName(source, file.name);
  if (!named) named = ReadName(source, DisplayPath(file.path.filename()));
  if (!named) return;
  const auto wanted = static_cast<std::size_t>(std::max(1, named->bodies));
  const Expected<People> people = NtuPeople(skeleton, source, wanted);
  if (!people) return;  // of its axes, which are no matter of people
  for (const Finding& finding : people->findings) {
    remarks.push_back(RemarkOf(finding));
  }
  const std::size_t there = people->chosen.size();
  if (there >= wanted) return;
  const Error missing = PersonNotThere(there + 1, wanted, *people, skeleton.frames.size(), file.name);
  remarks.push_back({"people_missing", Severity::kError, static_cast<double>(there), missing.what});
}

}  // namespace

Expected<std::vector<ObservedClip>> ObserveNtu(const FileBytes& file, const std::optional<SourceOptions>& source) {
  const std::string& name = file.name;
  Expected<NtuSkeleton> skeleton = ParseNtuSkeleton(file.bytes, name, DamagedRows::kReport);
  if (!skeleton) {
    Error error = skeleton.error();
    error.code = ErrorCode::kMalformed;  // kInconsistent is said of takes without a person
    return tl::unexpected<Error>(std::move(error));
  }
  NoteExchangedIds(MendsIds(source ? source->people : PeopleOptions()), *skeleton);
  std::vector<std::uint64_t> ids;
  std::size_t most = 0, fewest = skeleton->frames.empty() ? 0 : skeleton->frames[0].size();
  for (const std::vector<NtuBody>& frame : skeleton->frames) {
    most = std::max(most, frame.size());
    fewest = std::min(fewest, frame.size());
    for (const NtuBody& body : frame) {
      if (std::find(ids.begin(), ids.end(), body.id) == ids.end()) ids.push_back(body.id);
    }
  }
  if (skeleton->frames.empty()) {
    return Fail(ErrorCode::kInconsistent, "the file holds 0 frames", name, "leave the file out");
  }
  if (ids.empty()) {
    return Fail(ErrorCode::kInconsistent, "there is no body in any frame: the set's files with missing skeletons", name,
                "leave the file out");
  }
  std::vector<ObservedClip> clips;
  for (const std::uint64_t id : ids) {
    ObservedClip clip = BodyClip(*skeleton, id);
    clip.id = ids.size() > 1 ? "[" + std::to_string(clips.size()) + "]" : "";
    clip.people = static_cast<int>(most);
    clip.fewest_people = static_cast<int>(fewest);
    clip.people_evidence = "bodies of the file's frames; " + std::to_string(ids.size()) + " in all";
    clip.rate_evidence = "the file does not say it";
    clip.set_rate_hz = 30.0;
    clip.set_says = "the format is of the Kinect v2, which follows people at 30 Hz (Shahroudy et al. 2016)";
    clip.units = "m";
    clip.up = "+y";
    clip.handedness = "right";
    FollowFormat("ntu25", KinectJoints(), "25 joints of the Kinect v2", clip);
    clips.push_back(std::move(clip));
  }
  for (const Finding& finding : skeleton->findings) {
    clips[0].remarks.push_back(RemarkOf(finding));
  }
  if (const auto doubt = DoubtNtuName(file.path))
    clips[0].remarks.push_back({"name_contradiction", Severity::kWarning, 0.0, *doubt});
  if (source) ComparePeople(*skeleton, *source, file, clips[0].remarks);
  return clips;
}

}  // namespace mocurate
