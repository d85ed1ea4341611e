// The layouts c3d and trc: joints as points, in millimetres; a joint that was inferred is a point that was not seen.

#include <cmath>
#include <limits>

#include "canon/exports/clip_names.h"
#include "canon/exports/written_set.h"
#include "core/base/text.h"
#include "core/formats/c3d.h"
#include "core/formats/trc.h"

namespace mocurate {
namespace {

constexpr const char* kNotInPointNames = ":*,\t";
constexpr double kMillimetres = 1000.0;

/// Whether a joint's place is written: not where it was inferred nor, of tracks that were not fitted, in a gap between
/// observations.
bool IsShown(const Motion& motion, int frame, int joint) {
  if (motion.state.empty()) return true;
  const JointState state =
      motion.state[static_cast<std::size_t>(frame) * static_cast<std::size_t>(motion.joint_count()) +
                   static_cast<std::size_t>(joint)];
  return state != JointState::kInferred && !(motion.joints_only() && state == JointState::kInterpolated);
}

Expected<std::string> C3dOfClip(const Clip& clip, const ExportSet&) {
  const Motion& motion = *clip.motion;
  C3dFile c3d;
  c3d.scale = 0.1;
  c3d.first_frame = clip.identity.begin_frame + 1;
  c3d.frames = motion.frame_count();
  c3d.rate_hz = motion.rate.hz();
  c3d.units = "mm";
  c3d.x_screen = "+X";
  c3d.y_screen = "+Y";
  if (!clip.identity.person.empty()) c3d.subjects = {clip.identity.person};
  for (const std::string& name : JointNamesForFile(*motion.skeleton, kNotInPointNames))
    c3d.points.push_back({name, "", ""});
  for (int f = 0; f < motion.frame_count(); ++f) {
    for (int j = 0; j < motion.joint_count(); ++j) {
      const bool shown = IsShown(motion, f, j);
      const Vector3d place = shown ? Vector3d(kMillimetres * motion.joints.at(f, j)) : Vector3d(Vector3d::Zero());
      c3d.values.insert(c3d.values.end(), place.data(), place.data() + 3);
      c3d.residual.push_back(shown ? 0.0F : -1.0F);
    }
  }
  return WriteC3d(c3d, clip.id());
}

Expected<std::string> TrcOfClip(const Clip& clip, const ExportSet&) {
  const Motion& motion = *clip.motion;
  TrcFile trc;
  trc.recorded = WithoutControls(clip.identity.recording) + ".trc";
  trc.rate_hz = motion.rate.hz();
  trc.units = "mm";
  trc.names = JointNamesForFile(*motion.skeleton, kNotInPointNames);
  for (int f = 0; f < motion.frame_count(); ++f) {
    trc.frame_number.push_back(clip.identity.begin_frame + 1 + f);
    trc.time_s.push_back(std::round(1e6 * motion.rate.FrameTime(f)) / 1e6);
    for (int j = 0; j < motion.joint_count(); ++j) {
      for (int k = 0; k < 3; ++k) {
        const double micrometres = std::round(kMillimetres * kMillimetres * motion.joints.at(f, j)[k]);
        trc.values.push_back(IsShown(motion, f, j) ? micrometres / kMillimetres
                                                   : std::numeric_limits<double>::quiet_NaN());
      }
    }
  }
  return WriteTrc(trc);
}

std::vector<std::pair<std::string, std::string>> DeclareC3d(const ExportSet&, const FrameRate&) {
  return {{"format", "c3d"}, {"units", "mm"}};
}

std::vector<std::pair<std::string, std::string>> DeclareTrc(const ExportSet&, const FrameRate&) {
  return {{"format", "trc"}, {"units", "mm"}};
}

std::unique_ptr<LayoutWriter> MakePoints(const ExportSet& set, LabelledFolder folder) {
  folder.holds_rate = true;
  folder.declares_rate = false;
  folder.joint_table = true;
  folder.not_in_joint_names = kNotInPointNames;
  return MakeLabelledFolder(set, folder);
}

}  // namespace

std::unique_ptr<LayoutWriter> MakeC3dLayout(const ExportSet& set) {
  return MakePoints(set, {"c3d", ".c3d", C3dOfClip, DeclareC3d});
}

std::unique_ptr<LayoutWriter> MakeTrcLayout(const ExportSet& set) {
  return MakePoints(set, {"trc", ".trc", TrcOfClip, DeclareTrc});
}

}  // namespace mocurate
