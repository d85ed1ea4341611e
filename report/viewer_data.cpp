#include "report/viewer_data.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <functional>
#include <numeric>
#include <utility>

#include "core/base/pi.h"
#include "core/base/text.h"
#include "core/base/version.h"
#include "core/body/capsule_body.h"
#include "report/filmstrip.h"
#include "report/html.h"
#include "report/page_files.h"

namespace mocurate {
namespace {

constexpr double kTenths = 1e4;  // of a millimetre in a metre
constexpr double kMost16 = 32767.0;
const Vector3d kNowhere = Vector3d::Constant(std::nan(""));
constexpr int kMostUnit = 100;  // a point may be 327 m from its root

/// A rounded number, little-endian.
void Append16(double value, std::string& bytes) {
  const auto bits = static_cast<std::uint16_t>(std::lround(value));
  bytes += static_cast<char>(bits & 0xFFU);
  bytes += static_cast<char>(bits >> 8U);
}

/// Tenths of a millimetre of one step, so that every joint and point is within 16 bits of the root.
int UnitOf(const Motion& motion, const JointTracks* tracks) {
  double reach = 0.0;
  for (int f = 0; f < motion.frame_count(); ++f) {
    const Vector3d root = motion.joints.at(f, 0);
    for (int j = 1; j < motion.joint_count(); ++j) {
      const double apart = (motion.joints.at(f, j) - root).cwiseAbs().maxCoeff();
      if (std::isfinite(apart)) reach = std::max(reach, apart);
    }
    for (int k = 0; tracks != nullptr && k < tracks->positions.joints; ++k) {
      if (Observes(*tracks, f, k)) reach = std::max(reach, (tracks->positions.at(f, k) - root).cwiseAbs().maxCoeff());
    }
  }
  return std::clamp(static_cast<int>(std::ceil(kTenths * reach / kMost16)), 1, kMostUnit);
}

void AppendFloat(float value, std::string& bytes) {
  std::uint32_t bits = 0;
  std::memcpy(&bits, &value, sizeof(bits));
  for (unsigned shift = 0; shift < 32; shift += 8) bytes += static_cast<char>(bits >> shift & 0xFFU);
}

/// A place less the root; a missing one, or one that is beyond 16 bits, is -32768.
void AppendPlace(const Vector3d& from_root, double step, std::string& bytes) {
  const Vector3d steps = from_root / step;
  const bool seen = steps.allFinite() && steps.cwiseAbs().maxCoeff() <= kMost16;
  for (int i = 0; i < 3; ++i) Append16(seen ? steps[i] : -kMost16 - 1.0, bytes);
}

void Pad(std::string& bytes) { bytes.resize((bytes.size() + 3) / 4 * 4, '\0'); }

std::uint8_t SigmaCode(double sigma) {
  if (!std::isfinite(sigma) || sigma < 0.0) return 255;
  return static_cast<std::uint8_t>(std::min(254L, std::lround(16.0 * std::log2(1.0 + kTenths * sigma))));
}

/// The frames of a clip, in the layout of ViewerData.
std::string Packed(const ViewedClip& viewed, int unit) {
  const Motion& motion = *viewed.clip.motion;
  const int frames = motion.frame_count(), joints = motion.joint_count();
  const double step = unit / kTenths;
  std::string bytes;
  std::vector<Vector3d> roots;
  for (int f = 0; f < frames; ++f) {
    Vector3d root = motion.joints.at(f, 0);
    if (!root.allFinite()) root = roots.empty() ? Vector3d::Zero() : roots.back();  // its joint is a gap
    for (int i = 0; i < 3; ++i) AppendFloat(static_cast<float>(root[i]), bytes);
    roots.push_back(root.cast<float>().cast<double>());
  }
  for (int f = 0; f < frames; ++f) {
    for (int j = 0; j < joints; ++j) {
      // Tracks without a fit: a joint that was not observed for long is not known; the root may be the hips' middle.
      const bool gap = motion.joints_only() && j > 0 && !motion.state.empty() &&
                       motion.state[static_cast<std::size_t>(f) * joints + j] == JointState::kInferred;
      AppendPlace(gap ? kNowhere : Vector3d(motion.joints.at(f, j) - roots[f]), step, bytes);
    }
  }
  Pad(bytes);
  for (std::size_t i = 0; i < motion.rotation.size(); ++i) {
    const Eigen::AngleAxisd turn(motion.rotation[i]);
    const double angle = turn.angle() > kPi ? turn.angle() - 2.0 * kPi : turn.angle();
    const Vector3d vector = turn.axis() * angle;
    for (int k = 0; k < 3; ++k) Append16(std::clamp(vector[k] / kPi, -1.0, 1.0) * kMost16, bytes);
  }
  Pad(bytes);
  if (viewed.tracks != nullptr) {
    for (int f = 0; f < frames; ++f) {
      for (int k = 0; k < viewed.tracks->positions.joints; ++k) {
        const bool seen = Observes(*viewed.tracks, f, k);
        AppendPlace(seen ? Vector3d(viewed.tracks->positions.at(f, k) - roots[f]) : kNowhere, step, bytes);
      }
    }
    Pad(bytes);
  }
  for (const JointState state : motion.state) bytes += static_cast<char>(state);
  Pad(bytes);
  for (std::size_t i = 0; i + 5 < motion.position_cov.size(); i += 6) {
    const float* c = &motion.position_cov[i];
    bytes += static_cast<char>(SigmaCode(std::sqrt((c[0] + c[3] + c[5]) / 3.0)));
  }
  Pad(bytes);
  for (int f = 0; f < frames && !motion.contact.empty(); ++f) {
    bytes += static_cast<char>((motion.contact[2 * static_cast<std::size_t>(f)] != 0 ? 1 : 0) |
                               (motion.contact[2 * static_cast<std::size_t>(f) + 1] != 0 ? 2 : 0));
  }
  Pad(bytes);
  for (const std::vector<Vector3d>& cloud : viewed.clouds) Append16(static_cast<double>(cloud.size()), bytes);
  Pad(bytes);
  for (std::size_t f = 0; f < viewed.clouds.size(); ++f) {
    for (const Vector3d& place : viewed.clouds[f]) AppendPlace(place - roots[f], step, bytes);
  }
  Pad(bytes);
  return bytes;
}

/// Four strongest weights of a vertex, of sum 255, then their joints.
void AppendWeights(const double* weights, std::size_t joints, std::string& bytes) {
  constexpr std::size_t kWeights = 4;
  std::vector<std::pair<double, std::size_t>> strongest(std::max(joints, kWeights));
  for (std::size_t j = 0; j < joints; ++j) strongest[j] = {weights[j], j};
  std::partial_sort(strongest.begin(), strongest.begin() + kWeights, strongest.end(), std::greater<>());
  double sum = 0.0;
  for (std::size_t k = 0; k < kWeights; ++k) sum += strongest[k].first;
  std::array<long, kWeights> shares{255, 0, 0, 0};
  for (std::size_t k = 1; k < kWeights; ++k) {
    shares[k] = std::lround(255.0 * strongest[k].first / sum);
    shares[0] -= shares[k];
  }
  for (const long share : shares) bytes += static_cast<char>(share);
  for (std::size_t k = 0; k < kWeights; ++k) bytes += static_cast<char>(strongest[k].second);
}

/// A skin for scripts: {"parents", "joints" (3J), "vertices" int16 (V,3), both tenths of a millimetre, "faces" uint16
/// (F,3), "weights" uint8 (V,8): four weights of sum 255 and their joints}; arrays in base64.
nlohmann::json SkinJson(const Skin& skin, const Skeleton& skeleton) {
  nlohmann::json json = {{"parents", nlohmann::json::array()}, {"joints", nlohmann::json::array()}};
  for (std::size_t j = 0; j < skin.joints.size(); ++j) {
    json["parents"].push_back(skeleton.joints[j].parent);
    for (int i = 0; i < 3; ++i) json["joints"].push_back(std::lround(kTenths * skin.joints[j][i]));
  }
  std::string vertices, faces, weights;
  for (std::size_t v = 0; v < skin.vertices.size(); ++v) {
    for (int i = 0; i < 3; ++i) Append16(kTenths * skin.vertices[v][i], vertices);
    AppendWeights(&skin.weights[v * skin.joints.size()], skin.joints.size(), weights);
  }
  for (const std::array<int, 3>& face : skin.faces) {
    for (const int corner : face) Append16(corner, faces);
  }
  json["vertices"] = Base64(vertices);
  json["faces"] = Base64(faces);
  json["weights"] = Base64(weights);
  return json;
}

/// Eye and corners of a camera's view at 0.3 m, numbers in a row.
nlohmann::json FrustumOf(const Camera& camera) {
  constexpr double kDepth = 0.3;
  const RigidTransform world_from_camera = Inverse(camera.camera_from_world);
  nlohmann::json row = nlohmann::json::array();
  const auto add = [&row](const Vector3d& place) {
    for (int i = 0; i < 3; ++i) row.push_back(std::round(1e3 * place[i]) / 1e3);
  };
  add(camera.Centre());
  for (const Vector2d& pixel :
       {Vector2d(0.0, 0.0), Vector2d(camera.width - 1.0, 0.0), Vector2d(camera.width - 1.0, camera.height - 1.0),
        Vector2d(0.0, camera.height - 1.0)}) {
    add(world_from_camera * camera.Unproject(pixel, kDepth));
  }
  return row;
}

double Rounded(double value, double steps) { return std::round(value * steps) / steps; }

}  // namespace

std::vector<ViewedFinding> FindingsOf(const Clip& clip, const std::map<std::string, std::vector<Finding>>& by_id) {
  std::vector<ViewedFinding> viewed;
  const auto add = [&](const std::string& id, double hz, double from_s) {
    const auto found = by_id.find(id);
    if (found == by_id.end()) return;
    for (const Finding& finding : found->second) {
      const bool whole = finding.frame_end <= finding.frame_begin;
      const double begin = finding.frame_begin / hz - from_s, end = finding.frame_end / hz - from_s;
      if (!whole && (end <= 0.0 || begin >= clip.motion->duration())) continue;
      viewed.push_back({whole ? 0.0 : std::max(0.0, begin), whole ? 0.0 : end, finding});
    }
  };
  add(clip.id(), clip.motion->rate.hz(), 0.0);
  if (RecordingOf(clip.id()) != clip.id())
    add(RecordingOf(clip.id()), RecordedRate(clip).hz(), clip.identity.begin_frame / RecordedRate(clip).hz());
  return viewed;
}

int ViewerData::AddSource(const std::string& name) {
  sources_.push_back({{"name", name}});
  return static_cast<int>(sources_.size()) - 1;
}

int ViewerData::SkeletonOf(const Skeleton& skeleton) {
  nlohmann::json json = {{"name", skeleton.name},
                         {"joints", nlohmann::json::array()},
                         {"parents", nlohmann::json::array()},
                         {"radii", nlohmann::json::array()},
                         {"sides", SidesOf(skeleton)},
                         {"skin", -1}};
  for (const Joint& joint : skeleton.joints) {
    json["joints"].push_back(joint.name);
    json["parents"].push_back(joint.parent);
    json["radii"].push_back(std::lround(kTenths * joint.radius));
  }
  const auto [known, is_new] = known_skeletons_.emplace(json.dump(), static_cast<int>(skeletons_.size()));
  if (is_new) skeletons_.push_back(std::move(json));
  return known->second;
}

Expected<int> ViewerData::AddSkin(const Skin& skin, const Skeleton& skeleton) {
  constexpr std::size_t kMostJoints = 256, kMostVertices = 65536;
  if (skin.joints.size() > kMostJoints || skin.vertices.size() > kMostVertices) {
    return Fail(ErrorCode::kUnsupported,
                "a body of " + std::to_string(skin.joints.size()) + " joints and " +
                    std::to_string(skin.vertices.size()) + " vertices; a page has at most 256 and 65536",
                skeleton.name, "use SMPL or body_cc0");
  }
  nlohmann::json json = SkinJson(skin, skeleton);
  const auto [known, is_new] = known_skins_.emplace(json.dump(), static_cast<int>(skins_.size()));
  if (!is_new) return known->second;
  double length = 0.0;
  for (std::size_t j = 0; j < skin.joints.size(); ++j) {
    const int parent = skeleton.joints[j].parent;
    if (parent >= 0) length += (skin.joints[j] - skin.joints[static_cast<std::size_t>(parent)]).norm();
  }
  skin_lengths_.push_back(length);
  skins_.push_back(std::move(json));
  return known->second;
}

int ViewerData::BodyOf(const Clip& clip, double scale) {
  const Motion& motion = *clip.motion;
  if (motion.joints_only()) return -1;
  std::optional<CapsuleBody> body;
  const std::string radii = clip.Noted(kCapsuleRadii);
  if (!radii.empty()) body = BodyFromRadii(motion.skeleton, motion.bone_length, radii);
  if (!body && HasTemplateShape(*motion.skeleton)) body = CapsuleBody::Make(motion.skeleton, scale);
  if (!body) return -1;
  nlohmann::json json = nlohmann::json::array();
  for (const BodyCapsule& capsule : body->capsules) {
    nlohmann::json row = {capsule.frame, capsule.end_joint, std::lround(kTenths * capsule.radius)};
    for (const Vector3d& offset : {capsule.begin_offset, capsule.end_offset}) {
      for (int i = 0; i < 3; ++i) row.push_back(std::lround(kTenths * offset[i]));
    }
    json.push_back(std::move(row));
  }
  const auto [known, is_new] = known_bodies_.emplace(json.dump(), static_cast<int>(bodies_.size()));
  if (is_new) bodies_.push_back(std::move(json));
  return known->second;
}

Status ViewerData::Add(int source, const ViewedClip& viewed) {
  const Clip& clip = viewed.clip;
  const Motion& motion = *clip.motion;
  const int unit = UnitOf(motion, viewed.tracks);
  const std::string bytes = Packed(viewed, unit);
  const std::size_t most = parts_ == 0 ? part_bytes_ / 8 : part_bytes_;  // the first picture waits for the first part
  if (!part_.empty() && part_.size() + bytes.size() > most) {
    if (Status written = Finish(); !written) return written;
  }
  const double scale = BodyScale(*motion.skeleton, motion.bone_length);
  nlohmann::json json = {{"id", clip.id()},
                         {"source", source},
                         {"skeleton", SkeletonOf(*motion.skeleton)},
                         {"body", BodyOf(clip, scale)},
                         {"scale", Rounded(scale, 1e4)},
                         {"skin", motion.joints_only() ? -1 : viewed.skin},
                         {"frames", motion.frame_count()},
                         {"hz", motion.rate.hz()},
                         {"label", clip.label},
                         {"fine", clip.fine_label},
                         {"person", clip.identity.person},
                         {"part", viewed.part},
                         {"group", viewed.group},
                         {"residual", Rounded(1e3 * clip.fit_rms, 10.0)},
                         {"yaw", Rounded(FrontYaw(motion), 1e3)},
                         {"floor", nullptr},
                         {"unit", unit},
                         {"place", {parts_, part_.size()}},
                         {"has", nlohmann::json::array()},
                         {"segments", nlohmann::json::array()},
                         {"findings", nlohmann::json::array()}};
  if (viewed.place.is_array()) json["map"] = viewed.place;
  if (viewed.nearest.is_array()) json["nearest"] = viewed.nearest;
  if (clip.Noted(kHeightOrigin) == kOriginFloor) json["floor"] = 0.0;
  if (json["skin"] >= 0) {
    const double length = std::accumulate(motion.bone_length.begin(), motion.bone_length.end(), 0.0);
    json["skin_scale"] = Rounded(length / skin_lengths_[static_cast<std::size_t>(viewed.skin)], 1e4);
  }
  const auto has = [&](const char* field, bool there) {
    if (there) json["has"].push_back(field);
  };
  has("rotations", !motion.joints_only());
  has("state", !motion.state.empty());
  has("sigma", !motion.position_cov.empty());
  has("contact", !motion.contact.empty());
  has("clouds", !viewed.clouds.empty());
  if (viewed.tracks != nullptr) {
    const TrackDrawing drawing = MatchTracks(viewed.tracks->names, *motion.skeleton);
    std::vector<int> joint_of_point(viewed.tracks->names.size(), -1);
    for (std::size_t j = 0; j < drawing.point_of_joint.size(); ++j) {
      if (drawing.point_of_joint[j] >= 0)
        joint_of_point[static_cast<std::size_t>(drawing.point_of_joint[j])] = static_cast<int>(j);
    }
    json["points"] = {{"names", viewed.tracks->names}, {"joints", joint_of_point}};
  }
  json["cameras"] = nlohmann::json::array();
  for (const Camera& camera : viewed.cameras) json["cameras"].push_back(FrustumOf(camera));
  for (const Segment& segment : clip.segments) {
    json["segments"].push_back({segment.begin_s, segment.end_s, segment.label});
  }
  for (const auto& [begin_s, end_s, finding] : viewed.findings) {
    json["findings"].push_back({{"code", finding.code},
                                {"severity", Name(finding.severity)},
                                {"begin_s", Rounded(begin_s, 1e4)},
                                {"end_s", Rounded(end_s, 1e4)},
                                {"text", finding.message}});
  }
  clips_.push_back(std::move(json));
  part_ += bytes;
  return {};
}

Status ViewerData::Finish() {
  if (part_.empty()) return {};
  if (Status taken = sink_(parts_, part_); !taken) return taken;
  written_ += part_.size();
  ++parts_;
  part_.clear();
  return {};
}

nlohmann::json ViewerData::Index() const {
  return {{"schema", kViewerSchema}, {"sources", sources_}, {"skeletons", skeletons_},
          {"skins", skins_},         {"bodies", bodies_},   {"clips", clips_}};
}

std::string MotionsHtml(const nlohmann::json& index, const std::vector<std::string>& parts,
                        const std::vector<std::string_view>& scripts) {
  std::string html = "<script type=\"application/json\" id=\"viewer-index\">" + JsonForScript(index) + "</script>\n";
  const auto add_part = [&](std::size_t part) {
    html +=
        "<script type=\"text/plain\" id=\"mocurate-part-" + std::to_string(part) + "\">" + parts[part] + "</script>\n";
  };
  if (!parts.empty()) add_part(0);  // the first clip is drawn while the browser reads the others
  html += PageScripts(scripts);
  for (std::size_t part = 1; part < parts.size(); ++part) add_part(part);
  return html;
}

std::string ViewerHtml(const nlohmann::json& index, const std::vector<std::string>& parts,
                       const std::vector<std::string_view>& last) {
  std::vector<std::string_view> scripts = {"three.min.js", "data.js",     "figures.js", "stages.js",
                                           "timeline.js",  "clip_map.js", "viewer.js"};
  scripts.insert(scripts.end(), last.begin(), last.end());
  return MotionsHtml(index, parts, scripts);
}

std::string ViewerPage(const std::string& title, const nlohmann::json& index, const std::vector<std::string>& parts) {
  return PageHead(title, PageStyles({"viewer.css"})) +
         "<body>\n<main id=\"viewer\" style=\"max-width: none\"></main>\n<noscript>" +
         Paragraph("This page draws motions with JavaScript, which is switched off.") + "</noscript>\n" +
         ViewerHtml(index, parts, {"open.js"}) + "</body>\n</html>\n";
}

}  // namespace mocurate
