#include <algorithm>
#include <set>

#include "core/base/text.h"
#include "report/motion_rows.h"

namespace mocurate {
namespace {

bool IsLong(const NamedMotions& set) {
  return std::any_of(set.motions.clips.begin(), set.motions.clips.end(),
                     [](const Clip& clip) { return clip.segments.size() > 1; });
}

}  // namespace

Expected<std::vector<MotionRow>> ChooseMotionRows(const std::vector<NamedMotions>& sets,
                                                  const MotionPictureOptions& options) {
  std::vector<MotionRow> rows;
  const auto add = [&](const NamedMotions& set, const Clip& clip, const std::string& label) {
    rows.push_back({set.method, label, clip, std::nullopt});
  };
  std::set<std::string> known;
  for (const NamedMotions& set : sets) {
    for (const Clip& clip : set.motions.clips) {
      known.insert(clip.label);
      if (clip.motion && clip.motion->frame_count() > 0) continue;
      return Fail(ErrorCode::kInconsistent, "the clip has no motion to draw", clip.id(), "fit it first: mocurate fit");
    }
  }
  for (const std::string& wanted : options.clips) {
    const std::size_t before = rows.size();
    for (const NamedMotions& set : sets) {
      for (const Clip& clip : set.motions.clips) {
        if (EndsWith(clip.id(), wanted)) add(set, clip, clip.label);
      }
    }
    if (rows.size() > before) continue;
    return Fail(ErrorCode::kNotFound, "no clip id has this ending", wanted, "`mocurate inspect FILE` lists them");
  }
  std::vector<std::string> labels = options.labels;
  const bool some_long = std::any_of(sets.begin(), sets.end(), IsLong);
  for (const std::string& label : labels) {
    if (known.count(label) > 0) continue;
    std::vector<std::string> names(known.begin(), known.end());
    if (known == std::set<std::string>{""}) {
      return Fail(ErrorCode::kNotFound, "the motions have no labels", label, "choose clips by their ids with --clip");
    }
    return Fail(ErrorCode::kNotFound, "no motion has this label", label,
                WithoutControls(NearestOfAll(label, names, "the labels are: ")));
  }
  if (labels.empty() && options.clips.empty() && !some_long) {
    for (const NamedMotions& set : sets) {
      std::vector<std::string> own = set.motions.labels;
      if (known.count("") > 0) own.emplace_back();
      for (const std::string& label : own) {
        if (known.count(label) > 0 && std::find(labels.begin(), labels.end(), label) == labels.end()) {
          labels.push_back(label);
        }
      }
    }
  }
  const auto add_first = [&](const NamedMotions& set, const std::string* label) {
    std::int64_t count = 0;
    for (const Clip& clip : set.motions.clips) {
      if (count == options.samples) break;
      if (label != nullptr && clip.label != *label) continue;
      add(set, clip, clip.segments.size() > 1 ? "" : clip.label);
      ++count;
    }
  };
  if (options.clips.empty() && labels.empty()) {
    for (const NamedMotions& set : sets) add_first(set, nullptr);
  }
  for (const std::string& label : labels) {
    if (!options.clips.empty()) break;
    for (const NamedMotions& set : sets) add_first(set, &label);
  }
  if (rows.size() > static_cast<std::size_t>(options.most_rows)) {
    return Fail(ErrorCode::kUsage,
                Counted(static_cast<long long>(rows.size()), "row") + ", a picture has " +
                    std::to_string(options.most_rows) + " at most",
                "picture", "choose labels or clips, or fewer samples");
  }
  if (rows.empty())
    return Fail(ErrorCode::kInconsistent, "there is no motion to draw", "picture", "choose other files");
  return rows;
}

}  // namespace mocurate
