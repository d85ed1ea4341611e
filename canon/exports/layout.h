#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "canon/exports/motion_arrays.h"
#include "core/store/store.h"

namespace mocurate {

/// A file of an export; `path` is below the output folder, with '/' between folders.
struct ExportedFile {
  std::string path;
  std::string bytes;
};

/// Properties of the whole set that a layout needs before its first clip.
struct ExportSet {
  SkeletonPtr skeleton;
  bool joints_only = false;
  std::vector<std::string> ids;     ///< of the clips, in their order: "source/person/recording#begin-end"
  std::vector<std::string> labels;  ///< classes in the recipe's order
  std::vector<FineLabel> fine_labels;
  std::vector<Split> splits;                               ///< rows are positions in `ids`
  std::filesystem::path folder;                            ///< output folder, absolute: source.yaml may have to name it
  std::string file;                                        ///< name of a single output file; empty: its usual name
  RotationArrays rotations = RotationArrays::kQuaternion;  ///< for layouts with a choice
  /// ingest.source.checks of source.yaml, by code: the clips were checked when the set was made, so that no check drops
  /// one.
  std::map<std::string, std::string> checks;
};

/// Contents of a clip beside joints, label, rate and names.
enum class ClipContent {
  kRotations,
  kBoneLengths,
  kFineLabel,
  kSegments,
  kSession,
  kView,
  kStates,
  kUncertainty,
  kContacts
};

/// An export in progress: receives the clips one after the other and keeps none of them. Same clips, same bytes.
class LayoutWriter {
 public:
  virtual ~LayoutWriter() = default;
  /// The files of the clip at `position` of ExportSet::ids. Error: why the layout cannot write it; the export continues
  /// with the others.
  virtual Expected<std::vector<ExportedFile>> Add(std::size_t position, const Clip& clip) = 0;
  /// Takes back the clip that was added last: its files could not be written.
  virtual void RemoveLast() = 0;
  /// After the last clip: tables, and source.yaml, the declaration that reads the export again. Appends notes for the
  /// user about lost information.
  virtual Expected<std::vector<ExportedFile>> Finish(std::vector<std::string>& notes) = 0;
};

enum class LayoutTrait {
  kNeedsRotations,
  kRepresentations,  ///< uses ExportSet::rotations
  kAllInOneFile,     ///< a file of Layout::ending has all clips
  kOneSplit,         ///< writes only the first of ExportSet::splits
};

/// A row of the table of layouts.
struct Layout {
  std::string_view name;
  std::string_view help;
  std::string_view ending;  ///< of an output that is a single file, ".bvh"; empty: always a folder
  std::vector<LayoutTrait> traits;
  std::vector<ClipContent> carries;
  std::unique_ptr<LayoutWriter> (*make)(const ExportSet& set);

  bool Is(LayoutTrait trait) const;
  bool Carries(ClipContent content) const;
};

/// npz, humanact12, actor, amass_babel, csv, bvh, c3d, trc, glb.
const std::vector<Layout>& Layouts();
/// Null for an unknown name.
const Layout* FindLayout(std::string_view name);

/// Counts the contents of clips that a layout cannot write.
class NotCarried {
 public:
  explicit NotCarried(const Layout& layout) : layout_(layout) {}
  void Count(const Clip& clip);
  /// "not carried by bvh: segments of 12 clips, uncertainty of 180 clips"; empty when everything is carried.
  std::string Note() const;

 private:
  const Layout& layout_;
  std::vector<long long> clips_ = std::vector<long long>(9, 0);  ///< by ClipContent
};

/// The writers behind the table; each layout is described in docs/exports.md.
std::unique_ptr<LayoutWriter> MakeNpzLayout(const ExportSet& set);
std::unique_ptr<LayoutWriter> MakeCsvLayout(const ExportSet& set);
std::unique_ptr<LayoutWriter> MakeBvhLayout(const ExportSet& set);
std::unique_ptr<LayoutWriter> MakeC3dLayout(const ExportSet& set);
std::unique_ptr<LayoutWriter> MakeTrcLayout(const ExportSet& set);
std::unique_ptr<LayoutWriter> MakeGlbLayout(const ExportSet& set);
std::unique_ptr<LayoutWriter> MakeHumanAct12Layout(const ExportSet& set);
std::unique_ptr<LayoutWriter> MakeActorLayout(const ExportSet& set);
std::unique_ptr<LayoutWriter> MakeAmassBabelLayout(const ExportSet& set);

}  // namespace mocurate
