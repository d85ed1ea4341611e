#pragma once

#include <filesystem>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "core/base/finding.h"
#include "core/motion/clip.h"

namespace mocurate {

/// One split: clip rows per part, the rule in words, and what the leak check found.
struct Split {
  std::string name;
  std::vector<int> train;
  std::vector<int> validation;
  std::vector<int> test;
  std::string rule;
  std::string leak_check;  ///< "ok: no person in two parts", or what leaks
};

/// A fine label and the class that it is part of.
struct FineLabel {
  std::string name;
  int parent = 0;  ///< position in Dataset::labels
};

/// A Dataset or MotionSet: clips with motion, one skeleton, either all with rotations or all joints only.
struct Dataset {
  SkeletonPtr skeleton;
  bool joints_only = false;
  std::vector<Clip> clips;             ///< sorted by id; evidence not stored here
  std::vector<std::string> labels;     ///< classes; class index = position, a class may have no clip
  std::vector<FineLabel> fine_labels;  ///< of Clip::fine_label, in the order of their classes
  std::vector<Split> splits;
  std::vector<Finding> findings;
  std::string recipe;
  std::string created_by;  ///< program and version
  AxisConvention axes;     ///< canonical unless a foreign file declares others

  /// Position of a label; -1 when it is not there.
  int LabelIndex(const std::string& label) const;
  /// Position of a fine label; -1 when it is not there.
  int FineLabelIndex(const std::string& label) const;
  /// Null when it does not exist.
  const Split* FindSplit(const std::string& name) const;
};

/// Ground truth of a synthetic capture, in its own file group /truth/: motion per clip id.
struct Truth {
  std::map<std::string, Motion> motion;
};

/// The dataset file of design section 5, schema "mocurate/1". Same content, same bytes; the file appears atomically.
Status WriteDataset(const Dataset& dataset, const std::filesystem::path& path);
/// Checks the whole file against the table of fields and content_sha256. Error kMalformed names file and dataset path.
Expected<Dataset> ReadDataset(const std::filesystem::path& path);

/// An evidence artifact, schema "mocurate-evidence/1": one clip with evidence and possibly a given motion, and what was
/// found wrong or suspect while it was read from its source.
Status WriteEvidence(const Clip& clip, const std::filesystem::path& path, const std::vector<Finding>& findings = {});
/// `findings`, when given, gets those of the file.
Expected<Clip> ReadEvidence(const std::filesystem::path& path, std::vector<Finding>* findings = nullptr);

/// Truth, schema "mocurate-truth/1". No stage before `evaluate` opens it.
Status WriteTruth(const Truth& truth, const std::filesystem::path& path);
Expected<Truth> ReadTruth(const std::filesystem::path& path);

/// Whether a file is one of these by its schema; what it holds may be damaged.
bool IsStoreFile(const std::filesystem::path& path);
/// Whether a dataset file has rotations, not joints only.
bool HasStoredRotations(const std::filesystem::path& path);

/// What a file is and holds, as JSON: schema, skeleton, counts, fields with shape, type and unit.
Expected<nlohmann::json> DescribeStore(const std::filesystem::path& path);
/// The result of DescribeStore as a few lines of text.
std::string StoreText(const nlohmann::json& description);

/// Lines of these texts: "  name        text" (none for an empty text), and "9: a (12), b (3) and 7 more" of names with
/// their counts.
std::string DescriptionLine(const std::string& name, const std::string& text);
std::string TallyText(const nlohmann::json& tally);

}  // namespace mocurate
