#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/finding.h"
#include "core/motion/clip.h"
#include "core/skin/skin.h"

namespace mocurate {

/// Number of the layout of a viewer's index and parts; report/viewer/data.js has the same.
inline constexpr int kViewerSchema = 2;

/// A finding, seconds from the clip's first frame; both 0: about the whole clip.
struct ViewedFinding {
  double begin_s = 0.0;
  double end_s = 0.0;
  Finding finding;
};

/// Findings about a clip or about the recording that it is cut from, in the clip's time; those about other parts of
/// the recording are left out.
std::vector<ViewedFinding> FindingsOf(const Clip& clip, const std::map<std::string, std::vector<Finding>>& by_id);

/// A clip to view, with what is known beside its motion.
struct ViewedClip {
  const Clip& clip;
  std::vector<ViewedFinding> findings{};
  std::string part{};                   ///< of the first split: "train", "validation", "test"; or empty
  std::string group{};                  ///< with which clips of other sources it stands; empty: those of its recording
  const JointTracks* tracks = nullptr;  ///< observed points in the motion's world, one sample a frame
  std::vector<Camera> cameras{};        ///< in the motion's world
  std::vector<std::vector<Vector3d>> clouds{};  ///< (F) measured points, in the motion's world; or none
  int skin = -1;                                ///< number that AddSkin gave; -1: none
  nlohmann::json place{};                       ///< of the clip in the audit's map, [x, y]; or null
  nlohmann::json nearest{};                     ///< ids of the clips nearest to it; or null
};

/// Packs motions for the viewer: an index (JSON) and parts of some megabytes, each of whole clips, which the page
/// decodes when they are shown. Of a clip of F frames, J joints and K tracked points, little-endian, each array padded
/// to four bytes: the root (F,3) float32, metres; joints less the root (F,J,3) int16 in `unit` tenths of a millimetre,
/// -32768 a missing one; rotation vectors (F,J,3) int16, pi / 32767; tracked points less the root (F,K,3) int16; states
/// (F,J) uint8; standard deviation of a position (F,J) uint8, 16 log2(1 + sigma / 0.1 mm), 255: none; contacts (F)
/// uint8, bit 0 left; numbers of cloud points (F) uint16, then these less the root (,3) int16. Absent fields have no
/// array (`has`).
class ViewerData {
 public:
  /// Takes the bytes of a part that is full.
  using Sink = std::function<Status(int part, const std::string& bytes)>;

  explicit ViewerData(Sink sink, std::size_t part_bytes = std::size_t{3} << 20U)
      : sink_(std::move(sink)), part_bytes_(part_bytes) {}

  /// Returns the number of the source, which the page names.
  int AddSource(const std::string& name);
  /// Returns the number of a skin over the skeleton's joints. Error kUnsupported for one that is too large for a page.
  Expected<int> AddSkin(const Skin& skin, const Skeleton& skeleton);
  /// Errors of the sink.
  Status Add(int source, const ViewedClip& viewed);
  /// The last part.
  Status Finish();

  int parts() const { return parts_; }
  std::size_t clips() const { return clips_.size(); }
  std::size_t bytes() const { return written_; }
  /// {"schema", "sources", "skeletons", "skins", "bodies", "clips"}.
  nlohmann::json Index() const;

 private:
  int SkeletonOf(const Skeleton& skeleton);
  int BodyOf(const Clip& clip, double scale);

  Sink sink_;
  std::size_t part_bytes_;
  int parts_ = 0;
  std::size_t written_ = 0;
  std::string part_;
  nlohmann::json sources_ = nlohmann::json::array(), skeletons_ = nlohmann::json::array();
  nlohmann::json skins_ = nlohmann::json::array(), bodies_ = nlohmann::json::array();
  nlohmann::json clips_ = nlohmann::json::array();
  std::map<std::string, int> known_skeletons_, known_bodies_, known_skins_;
  std::vector<double> skin_lengths_;  ///< metres, all bones of each skin
};

/// Elements of a page with motions: the index, the parts that are inline (base64 texts), and the scripts.
std::string MotionsHtml(const nlohmann::json& index, const std::vector<std::string>& parts,
                        const std::vector<std::string_view>& scripts);
/// The same with the scripts of the viewer, then `last`.
std::string ViewerHtml(const nlohmann::json& index, const std::vector<std::string>& parts,
                       const std::vector<std::string_view>& last);

/// The page of an index whose parts are inline (base64 texts) or, where there are none, in the folder that the index
/// names ("beside").
std::string ViewerPage(const std::string& title, const nlohmann::json& index, const std::vector<std::string>& parts);

}  // namespace mocurate
