#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

#include "core/pipeline/runner.h"
#include "ingest/folder_listing.h"
#include "ingest/options.h"
#include "ingest/sources/pattern.h"

namespace mocurate {

/// Files of a source whose clips are many files each: those whose names differ in {camera} and {frame}
/// alone ({-} is passed over) are one clip, named by the first of them; depth images whose other fields are the clip's
/// belong to it. Empty for other sources.
class GroupedFiles {
 public:
  /// Folders below the source's that companions of its files (calibrations, masks) lie in.
  static int Depth(const SourceOptions& source);
  /// `files` sorted by name. Error kConfig for a broken pattern.
  static Expected<GroupedFiles> Of(const SourceOptions& source, const NamePattern& pattern,
                                   const std::vector<FolderFile>& files);

  bool empty() const { return clips_.empty(); }
  /// A file of a clip that is named by another one, a calibration, a mask or a depth image.
  bool BelongsToOtherClip(const std::string& name) const;
  /// The names of the files of the clip that `first` names: itself alone, of other sources.
  std::vector<std::string> NamesOf(const std::string& first) const;
  /// Replaces the inputs of the clip that `first` names: its files (role "source"; depth images, masks and clouds
  /// "depth"), and what calibrates its cameras (role "calibration"). Files that cannot be read are left to be missed.
  /// Error kUnreadable where all of them are such, or the calibration is; kNotFound naming the calibration.
  Status AddInputs(const std::string& first, const NameFields& fields, ItemSpec& item) const;

 private:
  std::vector<const FolderFile*> Companions(const NamePattern& pattern, const NameFields& fields) const;

  const SourceOptions* source_ = nullptr;
  const std::vector<FolderFile>* files_ = nullptr;
  std::map<std::string, std::vector<const FolderFile*>> clips_;  ///< by the name of the first file
  std::set<std::string> others_;
  std::vector<NamePattern> calibrations_;
  std::vector<NamePattern> masks_;         ///< none or one
  std::vector<std::string> depth_fields_;  ///< of the names of depth images, that clips have too
  std::map<NameFields, std::vector<const FolderFile*>> depth_;
};

/// Of a declaration of such files: which fields tell them apart, and what else is needed. Error kConfig.
Status CheckGrouped(const SourceOptions& source);

/// Items of several cameras' files of one performance become one each, with all of their files: the source files by
/// view, then the depth images. Error kConfig: a camera twice.
Status GroupViews(const SourceOptions& source, std::vector<ItemSpec>& items);

/// Depth images by those fields of their names that the names of the source's files have too.
class DepthFiles {
 public:
  /// `files` must outlive it.
  DepthFiles(const std::vector<FolderFile>& files, const NamePattern& pattern, const NamePattern& source);
  DepthFiles(std::vector<FolderFile>&&, const NamePattern&, const NamePattern&) = delete;

  /// Adds the images of the file that has these fields.
  void AddTo(const NameFields& fields, ItemSpec& item) const;

 private:
  std::vector<std::string> Key(const NameFields& fields) const;

  std::vector<std::string> common_;
  std::map<std::vector<std::string>, std::vector<const FolderFile*>> of_;
};

/// Error kConfig, with two clips of different files that have one depth image in common. People of one recording whose
/// keypoints lie apart may have: a camera beside the detector sees them all.
Status CheckOwnImages(const SourceOptions& source, const std::vector<ItemSpec>& items);

}  // namespace mocurate
