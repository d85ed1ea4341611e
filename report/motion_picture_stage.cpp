#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>

#include "core/base/file.h"
#include "core/base/json_text.h"
#include "core/base/text.h"
#include "report/motion_rows.h"
#include "report/stages.h"

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
  const auto row_of = [&](const NamedMotions& set, const std::string& label, std::vector<Clip> clips) {
    MotionRow row{set.method, label, std::move(clips)};
    if (const auto head = options.columns.find(set.method); head != options.columns.end()) row.column = head->second;
    if (const auto own = options.colours.find(set.method); own != options.colours.end()) {
      row.colour = own->second == "red" ? kRed : own->second == "green" ? kGreen : kBlue;
    }
    rows.push_back(std::move(row));
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
        if (IsCalled(clip, wanted) || EndsWith(clip.id(), wanted)) row_of(set, clip.label, {clip});
      }
    }
    if (rows.size() > before) continue;
    return Fail(ErrorCode::kUsage, "no clip id has this ending", wanted, "`mocurate inspect FILE` lists them");
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
  const auto joins = [&](const NamedMotions& set) {
    return std::find(options.joined.begin(), options.joined.end(), set.method) != options.joined.end();
  };
  const auto add_first = [&](const NamedMotions& set, const std::string* label) {
    std::int64_t count = 0;
    for (const Clip& clip : set.motions.clips) {
      if (count == options.samples) break;
      if (label != nullptr && clip.label != *label) continue;
      row_of(set, clip.segments.size() > 1 ? "" : clip.label, {clip});
      ++count;
    }
    if (count > 0 || options.labels.empty() || options.scene) return;
    row_of(set, *label, {});
    rows.back().why = "no motion of this label";
  };
  for (const NamedMotions& set : sets) {
    if (!options.clips.empty()) break;
    if (joins(set)) {
      row_of(set, "", set.motions.clips);
    } else if (labels.empty()) {
      add_first(set, nullptr);
    }
  }
  for (const std::string& label : labels) {
    for (const NamedMotions& set : sets) {
      if (options.clips.empty() && !joins(set)) add_first(set, &label);
    }
  }
  if (rows.size() > static_cast<std::size_t>(options.most_rows)) {
    return Fail(ErrorCode::kUsage,
                Counted(static_cast<long long>(rows.size()), "row") + ", a picture has " +
                    std::to_string(options.most_rows) + " at most",
                "picture", "choose labels or clips, or fewer samples");
  }
  if (rows.empty())
    return Fail(ErrorCode::kInconsistent, "there is no motion to draw", "picture", "choose other files");
  if (!options.themes.empty() && options.themes.size() != rows.size()) {
    return Fail(ErrorCode::kInconsistent,
                Counted(static_cast<long long>(options.themes.size()), "theme") + " for " +
                    Counted(static_cast<long long>(rows.size()), "row"),
                "picture", "give each row its theme");
  }
  for (std::size_t r = 0; r < options.themes.size(); ++r) rows[r].theme = options.themes[r];
  for (const auto& [method, why] : options.absent) rows.push_back({method, "", {}, std::nullopt, why});
  return rows;
}

Expected<std::vector<MotionRow>> ReadRows(const StageRequest& request, const MotionPictureOptions& options) {
  std::vector<NamedMotions> sets;
  for (const StageInput& input : request.inputs) {
    if (input.role != "motions") continue;
    auto set = ReadDataset(input.path);
    if (!set) return Forward(set);
    sets.push_back({input.name, std::move(*set)});
  }
  auto rows = ChooseMotionRows(sets, options);
  if (!rows || options.figure != FigureChoice::kSkin) return rows;
  const StageInput* body = FindInput(request, "body");
  if (body == nullptr) return Fail(ErrorCode::kInternal, "drawing a skin needs a body", request.item);
  for (MotionRow& row : *rows) {
    for (const Clip& clip : row.clips) {
      if (clip.motion->joints_only()) {
        return Fail(ErrorCode::kUnsupported, "the motion has no rotations to pose a skin with", clip.id(),
                    "draw bones or capsules, or fit it first: mocurate fit");
      }
      auto skin = ReadSkin(body->path, *clip.motion->skeleton);
      if (!skin) return Forward(skin);
      row.skin = std::move(*skin);
    }
  }
  return rows;
}

Expected<StageOutcome> MotionPictureStage(const StageRequest& request) {
  const auto options = OptionsFromJson<MotionPictureOptions>(request.options, "draw");
  if (!options) return Forward(options);
  const auto rows = ReadRows(request, *options);
  if (!rows) return Forward(rows);
  const Drawing drawing = DrawMotionRows(*rows, *options);
  constexpr double kMostPixels = 2e8;  // OpenCV's image of them takes 0.6 GB
  const double pixels = drawing.width * drawing.height * options->scale * options->scale;
  if (options->format == PictureFormat::kPng && pixels > kMostPixels) {
    return Fail(ErrorCode::kUsage, RoundedText(pixels / 1e6, 3) + " million pixels, a PNG has 200 million at most",
                "picture", "use a smaller --scale, fewer rows or stills, or .svg");
  }
  const std::string bytes = options->format == PictureFormat::kSvg ? ToSvg(drawing) : ToPng(drawing, options->scale);
  if (Status written = WriteFile(request.output, bytes); !written) return Forward(written);
  StageOutcome outcome;
  outcome.summary = {{"rows", rows->size()},
                     {"width", drawing.width},
                     {"height", drawing.height},
                     {"shown", DescribeRows(*rows, *options)}};
  return outcome;
}

}  // namespace mocurate
