#pragma once

#include <optional>
#include <string>
#include <vector>

namespace mocurate {

// Of a name: ASCII.
inline bool IsDigit(char c) { return c >= '0' && c <= '9'; }
inline bool IsLetter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); }
inline bool IsAlnum(char c) { return IsDigit(c) || IsLetter(c); }

/// "a/b" of "a/b/c.bvh"; empty of a name without a folder.
std::string FolderOf(const std::string& name);

/// A pattern that all of some names follow, by what they have in common.
struct NamePatternEstimate {
  std::string pattern;              ///< as ingest.source.files; "{part1}.bvh" where the names have no common form
  std::vector<std::string> fields;  ///< part1, part2, ... in order
  bool common = false;              ///< the names have a form in common
};

/// What names of one form share: folders, the places of '_', the ending.
std::string FormOf(const std::string& name);

/// Names are cut at '/', '_', '-' and blanks where all are alike, else at '/' and '_'. A part that is the same in all
/// stays, as do letters that are the same before differing digits ("a01": "a{part1}"); every other part is a field.
/// What the fields mean is not estimated.
NamePatternEstimate EstimateNamePattern(const std::vector<std::string>& names);

/// For files that belong to others ("HDM_bd.asf" to "01/HDM_bd_jog_001.amc"): a text of the pattern's fields that gives
/// each of `belonging` from the name at the same place of `names`; empty ones are not asked. Nothing where there is
/// none.
std::optional<std::string> EstimateCompanionPattern(const NamePatternEstimate& estimate,
                                                    const std::vector<std::string>& names,
                                                    const std::vector<std::string>& belonging);

/// How the files of clips of many files are named.
struct FramePattern {
  std::string pattern;       ///< "{recording}/{camera}_json/{camera}.{frame}.json"
  bool recording = false;    ///< the pattern has {recording}
  std::size_t matching = 0;  ///< names that follow it
};

/// From one file of each folder: the last digits are the frame, what folder and file have in common before them is the
/// camera (without `cameras`, the folder is the recording). Empty where less than half of the names are alike.
std::optional<FramePattern> EstimateFramePattern(const std::vector<std::string>& files, bool cameras);

/// Files of a camera each: what stands before and after the camera's own part of their names.
struct CameraNames {
  std::string before;
  std::string after;
  std::vector<std::string> cameras;  ///< the parts in between
};

/// What all names share at both ends, up to a letter or digit that differs. "0001_camera.xml": "", "_camera.xml".
/// Each name counts once.
CameraNames NamesOfCameras(const std::vector<std::string>& all);

}  // namespace mocurate
