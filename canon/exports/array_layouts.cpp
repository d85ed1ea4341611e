// The layouts npz and csv: a clip as arrays, or as a table.

#include <cmath>
#include <cstdio>

#include "canon/exports/clip_names.h"
#include "canon/exports/written_set.h"
#include "core/base/table_text.h"
#include "core/base/text.h"
#include "core/motion/kinematics.h"

namespace mocurate {
namespace {

constexpr const char* kNotInCsvNames = ", \"";

using DeclaredOptions = std::vector<std::pair<std::string, std::string>>;

std::string RateText(const FrameRate& rate) { return FormatDouble(rate.hz()) + " Hz"; }

Expected<std::string> NpzOfClip(const Clip& clip, const ExportSet& set) {
  const Expected<Npz> arrays = ArraysOfMotion(clip, set.rotations);
  if (!arrays) return Forward(arrays);
  return EncodeNpz(*arrays, clip.id());
}

DeclaredOptions DeclareNpz(const ExportSet&, const FrameRate& rate) {
  return {{"format", "npy"}, {"units", "m"}, {"rate", RateText(rate)}};
}

/// A number with six decimals: micrometres and microseconds.
void AppendMicro(double value, std::string& text) {
  char digits[64];
  const int length = std::snprintf(digits, sizeof(digits), "%.6f", value);
  text.append(digits, static_cast<std::size_t>(length));
}

/// "time_s,pelvis_x,pelvis_y,pelvis_z,...", then a row a frame: seconds from the first frame, metres.
Expected<std::string> CsvOfClip(const Clip& clip, const ExportSet&) {
  Motion motion = *clip.motion;
  if (!motion.joints_only()) ComputeJoints(motion);
  std::string text = "time_s";
  for (const std::string& name : JointNamesForFile(*motion.skeleton, kNotInCsvNames)) {
    for (const char* axis : {"_x", "_y", "_z"}) text += "," + CsvCell(name + axis);
  }
  text += '\n';
  const std::size_t numbers = 3 * static_cast<std::size_t>(motion.joint_count());
  for (int f = 0; f < motion.frame_count(); ++f) {
    AppendMicro(motion.rate.FrameTime(f), text);
    for (std::size_t i = 0; i < numbers; ++i) {
      text += ',';
      AppendMicro(motion.joints.xyz[static_cast<std::size_t>(f) * numbers + i], text);
    }
    text += '\n';
  }
  return text;
}

DeclaredOptions DeclareCsv(const ExportSet& set, const FrameRate& rate) {
  std::vector<std::string> joints;
  for (const Joint& joint : set.skeleton->joints) joints.push_back(joint.name);
  return {{"format", "joint_table"},
          {"units", "m"},
          {"rate", RateText(rate)},
          {"layout", YamlQuoted("skip " + std::to_string(joints.size()) + "*(x y z)")},
          {"joints", YamlList(joints)}};
}

}  // namespace

std::unique_ptr<LayoutWriter> MakeNpzLayout(const ExportSet& set) {
  LabelledFolder folder{"npz", ".npz", NpzOfClip, DeclareNpz};
  folder.holds_rate = true;
  return MakeLabelledFolder(set, folder);
}

std::unique_ptr<LayoutWriter> MakeCsvLayout(const ExportSet& set) {
  LabelledFolder folder{"csv", ".csv", CsvOfClip, DeclareCsv};
  folder.joint_table = true;
  folder.not_in_joint_names = kNotInCsvNames;
  return MakeLabelledFolder(set, folder);
}

}  // namespace mocurate
