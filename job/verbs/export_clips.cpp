#include "job/verbs/export_clips.h"

#include <algorithm>
#include <map>
#include <memory>
#include <set>

#include "core/base/file.h"
#include "core/base/text.h"
#include "core/store/dataset_clips.h"
#include "ingest/checks/check_options.h"
#include "job/motion_files.h"

namespace mocurate {
namespace {

bool EndsWith(const std::string& text, const std::string& end) {
  return text.size() >= end.size() && text.compare(text.size() - end.size(), end.size(), end) == 0;
}

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

/// Rows of a split as positions among the chosen clips.
Split AmongChosen(Split split, const std::vector<std::size_t>& rows) {
  std::map<int, int> position;
  for (std::size_t i = 0; i < rows.size(); ++i) position[static_cast<int>(rows[i])] = static_cast<int>(i);
  for (std::vector<int>* part : {&split.train, &split.validation, &split.test}) {
    std::vector<int> chosen;
    for (const int row : *part) {
      if (const auto at = position.find(row); at != position.end()) chosen.push_back(at->second);
    }
    *part = std::move(chosen);
  }
  return split;
}

/// The split of --split; without it all.
Expected<std::vector<Split>> ChosenSplits(const std::vector<Split>& splits, const std::vector<std::size_t>& rows,
                                          const ExportArguments& arguments) {
  std::vector<Split> chosen;
  std::vector<std::string> names;
  for (const Split& split : splits) {
    names.push_back(split.name);
    if (arguments.split.empty() || split.name == arguments.split) chosen.push_back(AmongChosen(split, rows));
  }
  if (arguments.split.empty() || !chosen.empty()) return chosen;
  std::string known;
  for (const std::string& name : names) known += (known.empty() ? "the splits are " : ", ") + name;
  return Fail(ErrorCode::kUsage, "there is no split '" + arguments.split + "'", DisplayPath(arguments.path),
              known.empty() ? "it has no split: remove --split" : known);
}

Status Choose(const std::vector<std::string>& ids, const std::vector<Split>& splits, const ExportArguments& arguments,
              std::vector<std::size_t>& rows, ExportSet& set) {
  Expected<std::vector<std::size_t>> chosen = ChosenRows(ids, arguments);
  if (!chosen) return Forward(chosen);
  rows = std::move(*chosen);
  Expected<std::vector<Split>> of_rows = ChosenSplits(splits, rows, arguments);
  if (!of_rows) return Forward(of_rows);
  set.splits = std::move(*of_rows);
  for (const std::size_t row : rows) set.ids.push_back(ids[row]);
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
