#include "ingest/synthetic/studio_layouts.h"

#include <nlohmann/json.hpp>
#include <optional>

#include "core/base/file.h"
#include "core/base/version.h"
#include "core/store/body_file.h"
#include "ingest/synthetic/layout.h"
#include "ingest/synthetic/sequence_plan.h"

namespace mocurate {
namespace {

struct LayoutRow {
  StudioLayout layout;
  std::int64_t subjects;  ///< of the real set
  Status (*write)(const StudioOptions&, const std::vector<Actor>&, StudioFolder&);
};

constexpr LayoutRow kLayouts[] = {{StudioLayout::kHumanAct12, kHumanAct12Subjects, WriteHumanAct12Layout},
                                  {StudioLayout::kPhspd, kHumanAct12Subjects, WritePhspdLayout},
                                  {StudioLayout::kNtu, 40, WriteNtuLayout},
                                  {StudioLayout::kKard, 10, WriteKardLayout},
                                  {StudioLayout::kUestc, 118, WriteUestcLayout},
                                  {StudioLayout::kUestcVibe, 118, WriteUestcVibeLayout},
                                  {StudioLayout::kNtuVibe, 40, WriteNtuVibeLayout},
                                  {StudioLayout::kOpenPose, 2, WriteOpenPoseLayout},
                                  {StudioLayout::kAmass, 4, WriteAmassLayout},
                                  {StudioLayout::kDepthSequence, 2, WriteDepthSequenceLayout}};

const LayoutRow& RowOf(StudioLayout layout) {
  for (const LayoutRow& row : kLayouts) {
    if (row.layout == layout) return row;
  }
  return kLayouts[0];
}

Status CheckFolder(const std::filesystem::path& folder) {
  std::error_code unreadable;
  if (!std::filesystem::exists(folder, unreadable)) return {};
  if (!std::filesystem::is_directory(folder, unreadable)) {
    return Fail(ErrorCode::kCannotWrite, "this is a file, not a folder", DisplayPath(folder), "choose another with -o");
  }
  if (std::filesystem::is_empty(folder, unreadable)) return {};
  return Fail(ErrorCode::kCannotWrite, "the folder holds something already", DisplayPath(folder),
              std::filesystem::exists(folder / StudioFolder::kWhole, unreadable)
                  ? "choose another with -o, or remove it: the studio mixes nothing with other files"
                  : "choose another with -o; where an earlier run was broken off there is no studio.json: remove it");
}

/// HumanAct12's classes where the layout performs them by clip; others check their own.
Status CheckActions(const StudioOptions& options) {
  if (options.layout != StudioLayout::kHumanAct12 && options.layout != StudioLayout::kPhspd) return {};
  return CheckVariants(options.actions);
}

}  // namespace

Expected<StudioFolder::Counts> WriteStudioLayout(const StudioOptions& options, const std::filesystem::path& folder,
                                                 int jobs) {
  if (Status free = CheckFolder(folder); !free) return Forward(free);
  if (Status known = CheckActions(options); !known) return Forward(known);
  std::optional<BodyTemplate> body;
  if (!options.body.empty()) {
    Expected<BodyTemplate> read = ReadBodyTemplate(options.body);
    if (!read) return Forward(read);
    body = std::move(*read);
  }
  const LayoutRow& row = RowOf(options.layout);
  const std::int64_t people = options.subjects > 0 ? options.subjects : row.subjects;
  const auto actors = ActorsOf(options, people, body ? &*body : nullptr);
  if (!actors) return Forward(actors);
  StudioFolder files(folder, std::max(1, jobs));
  if (Status written = row.write(options, *actors, files); !written) return Forward(written);
  StudioOptions said = options;
  said.body = options.body.filename();  // where it lay does not matter
  const StudioFolder::Counts counts = files.counts();
  const nlohmann::json made = {{"created_by", CreatedBy()},
                               {"options", OptionsToJson(said)},
                               {"clips", counts.clips},
                               {"frames", counts.frames}};
  if (Status whole = files.Finish(made.dump(1) + "\n"); !whole) return Forward(whole);
  return files.counts();
}

}  // namespace mocurate
