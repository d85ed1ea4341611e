#include "job/verbs/export_clips.h"

#include <algorithm>
#include <map>
#include <memory>
#include <set>

#include "canon/splits/leaks.h"
#include "core/base/file.h"
#include "core/base/text.h"
#include "core/store/dataset_clips.h"
#include "ingest/checks/finding_table.h"
#include "job/motion_files.h"

namespace mocurate {
namespace {

/// Rows of the clips whose id is a name of --clip, or ends with it; all without names. Error for the first name without
/// a clip.
Expected<std::vector<std::size_t>> ChosenRows(const std::vector<std::string>& ids, const ExportArguments& arguments) {
  std::set<std::string> found;
  std::vector<std::size_t> rows;
  for (std::size_t row = 0; row < ids.size(); ++row) {
    bool wanted = arguments.clips.empty();
    for (const std::string& name : arguments.clips) {
      if (ids[row] != name && !EndsWith(ids[row], name)) continue;
      found.insert(name);
      wanted = true;
    }
    if (wanted) rows.push_back(row);
  }
  for (const std::string& name : arguments.clips) {
    if (found.count(name) != 0) continue;
    const std::string example = ids.empty() ? "" : ", e.g. --clip '" + ids.front() + "'";
    return Fail(ErrorCode::kUsage, "no clip has the id '" + name + "'", DisplayPath(arguments.path),
                "`mocurate inspect` lists the ids" + example);
  }
  if (rows.empty()) return Fail(ErrorCode::kInconsistent, "the file has no clips", DisplayPath(arguments.path));
  return rows;
}

/// The split of --split; without it all.
Expected<std::vector<Split>> ChosenSplits(const std::vector<Split>& splits, const ExportArguments& arguments) {
  if (arguments.split.empty()) return splits;
  std::vector<std::string> names;
  for (const Split& split : splits) {
    names.push_back(split.name);
    if (split.name == arguments.split) return std::vector<Split>{split};
  }
  return Fail(ErrorCode::kUsage, "there is no split '" + arguments.split + "'", DisplayPath(arguments.path),
              names.empty() ? "it has no split: remove --split" : "the splits are " + JoinTexts(names));
}

Status Choose(const std::vector<std::string>& ids, const std::vector<Split>& splits, const ExportArguments& arguments,
              std::vector<std::size_t>& rows, ExportSet& set) {
  Expected<std::vector<std::size_t>> chosen = ChosenRows(ids, arguments);
  if (!chosen) return Forward(chosen);
  rows = std::move(*chosen);
  Expected<std::vector<Split>> of_set = ChosenSplits(splits, arguments);
  if (!of_set) return Forward(of_set);
  set.splits = std::move(*of_set);
  std::vector<int> positions(ids.size(), -1);  // of each row among the chosen
  for (const std::size_t row : rows) {
    positions[row] = static_cast<int>(set.ids.size());
    set.ids.push_back(ids[row]);
  }
  for (Split& split : set.splits) MoveRows(positions, split);
  return {};
}

Expected<ClipsToExport> OpenDataset(const ExportArguments& arguments) {
  Expected<DatasetClips> opened = DatasetClips::Open(arguments.path, DatasetClips::Check::kHashes);
  if (!opened) return Forward(opened);
  if (!(opened->axes() == AxisConvention())) {
    return Fail(ErrorCode::kUnsupported, "the axes of the file are '" + opened->axes().Text() + "', not '+x +y +z'",
                DisplayPath(arguments.path), "convert the file to right-handed axes, y up, facing +z");
  }
  const auto clips = std::make_shared<const DatasetClips>(std::move(*opened));
  std::vector<std::string> ids;
  for (std::size_t row = 0; row < clips->size(); ++row) ids.push_back(clips->Id(row));
  ClipsToExport open;
  std::vector<std::size_t> rows;
  if (Status known = Choose(ids, clips->splits(), arguments, rows, open.set); !known) return Forward(known);
  open.set.skeleton = clips->skeleton();
  open.set.joints_only = !HasStoredRotations(arguments.path);
  const auto outline = clips->Outline();
  if (!outline) return Forward(outline);
  open.set.labels = outline->labels;
  open.set.fine_labels = outline->fine_labels;
  open.read = [clips, rows](std::size_t position) { return clips->Read(rows[position]); };
  return open;
}

Expected<ClipsToExport> ReadFiles(const ExportArguments& arguments, const ConfigRules& rules) {
  Expected<DeclaredMotions> declared = DeclareMotions(arguments.path, arguments.source, rules);
  if (!declared) return Forward(declared);
  Expected<ReadMotions> read = ReadAllMotions({declared->ingest, {}});
  if (!read) return Forward(read);
  const auto set = std::make_shared<const Dataset>(std::move(read->set));
  std::vector<std::string> ids;
  for (const Clip& clip : set->clips) ids.push_back(clip.id());
  ClipsToExport open;
  std::vector<std::size_t> rows;
  if (Status known = Choose(ids, set->splits, arguments, rows, open.set); !known) return Forward(known);
  open.set.skeleton = set->skeleton;
  open.set.joints_only = set->joints_only;
  open.set.labels = set->labels;
  open.set.fine_labels = set->fine_labels;
  open.read = [set, rows](std::size_t position) { return Expected<Clip>(set->clips[rows[position]]); };
  open.refused = std::move(read->refused);
  for (RefusedClip& refused : declared->unreadable) open.refused.push_back(std::move(refused));
  return open;
}

/// Checks that would exclude clips or joints at ingest are only reported, and a first root at the origin is ignored.
std::map<std::string, std::string> ActionsOfChecks() {
  std::map<std::string, std::string> actions = {{"zero_joint", "{action: ignore}"}};
  for (const std::string& code : CheckCodes()) {
    if (CheckOptions().ActionFor(code) != OnFinding::kReport) actions[code] = "{action: report}";
  }
  return actions;
}

}  // namespace

Expected<ClipsToExport> OpenClipsToExport(const ExportArguments& arguments, const ConfigRules& rules) {
  const bool ours = arguments.source.empty() && IsMotionStore(arguments.path);
  Expected<ClipsToExport> open = ours ? OpenDataset(arguments) : ReadFiles(arguments, rules);
  if (open) open->set.checks = ActionsOfChecks();
  return open;
}

}  // namespace mocurate
