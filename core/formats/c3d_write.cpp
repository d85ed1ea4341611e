#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <map>

#include "core/base/text.h"
#include "core/formats/c3d.h"

namespace mocurate {
namespace {

constexpr std::size_t kBlockBytes = 512, kMostExtent = 255, kMostBlocks = 255;
constexpr int kFull16 = 65535;
constexpr double kStepsOfIntegers = 32000.0;

/// Bytes as a processor has them.
class C3dBytes {
 public:
  explicit C3dBytes(C3dProcessor processor) : processor_(processor) {}

  std::string bytes;

  void Byte(int value) { bytes += static_cast<char>(static_cast<unsigned char>(value & 0xff)); }
  void Word(int value) {
    const int low = value & 0xff, high = value >> 8 & 0xff;
    Byte(processor_ == C3dProcessor::kSgi ? high : low);
    Byte(processor_ == C3dProcessor::kSgi ? low : high);
  }
  void Float(double number) {
    const auto value = static_cast<float>(processor_ == C3dProcessor::kDec ? 4.0 * number : number);
    std::uint32_t bits = 0;
    std::memcpy(&bits, &value, sizeof(bits));
    const int high = static_cast<int>(bits >> 16), low = static_cast<int>(bits & 0xffff);
    Word(processor_ == C3dProcessor::kIntel ? low : high);
    Word(processor_ == C3dProcessor::kIntel ? high : low);
  }
  void FillBlock() { bytes.resize((bytes.size() + kBlockBytes - 1) / kBlockBytes * kBlockBytes, '\0'); }

  void Group(int id, const std::string& name) {
    Byte(static_cast<int>(name.size()));
    Byte(-id);
    bytes += name;
    Word(3);  // to the next record: this word and the length of no description
    Byte(0);
  }
  /// `data` is written; its extents are given.
  void Parameter(int group, const std::string& name, int type, const std::vector<std::size_t>& extents,
                 const std::string& data) {
    Byte(static_cast<int>(name.size()));
    Byte(group);
    bytes += name;
    Word(static_cast<int>(2 + 2 + extents.size() + data.size() + 1));
    Byte(type);
    Byte(static_cast<int>(extents.size()));
    for (const std::size_t extent : extents) Byte(static_cast<int>(extent));
    bytes += data;
    Byte(0);
  }
  void Words(int group, const std::string& name, const std::vector<int>& values) {
    C3dBytes data(processor_);
    for (const int value : values) data.Word(value);
    Parameter(group, name, 2, values.size() == 1 ? std::vector<std::size_t>() : std::vector<std::size_t>{values.size()},
              data.bytes);
  }
  void Real(int group, const std::string& name, double value) {
    C3dBytes data(processor_);
    data.Float(value);
    Parameter(group, name, 4, {}, data.bytes);
  }
  void Text(int group, const std::string& name, const std::string& text) {
    Parameter(group, name, -1, {std::min(text.size(), kMostExtent)}, text.substr(0, kMostExtent));
  }
  /// 255 texts at most in each of NAME, NAME2, ..., as long as the longest.
  void Texts(int group, const std::string& name, const std::vector<std::string>& texts) {
    for (std::size_t begin = 0; begin < texts.size(); begin += kMostExtent) {
      const std::size_t end = std::min(texts.size(), begin + kMostExtent);
      std::size_t length = 1;
      for (std::size_t i = begin; i < end; ++i) length = std::max(length, std::min(texts[i].size(), kMostExtent));
      std::string data;
      for (std::size_t i = begin; i < end; ++i) {
        data += texts[i].substr(0, length);
        data.resize((i - begin + 1) * length, ' ');
      }
      const std::string part = begin == 0 ? "" : std::to_string(begin / kMostExtent + 1);
      Parameter(group, name + part, -1, {length, end - begin}, data);
    }
  }

 private:
  C3dProcessor processor_;
};

/// The parameter section, whose end is where samples begin: in block `data_block`, from 1.
std::string ParametersOf(const C3dFile& c3d, double scale, int data_block, std::size_t blocks) {
  C3dBytes out(c3d.processor);
  out.bytes = {'\1', '\x50'};
  out.Byte(static_cast<int>(blocks));
  out.Byte(static_cast<int>(c3d.processor));
  constexpr int kPoint = 1, kAnalog = 2, kPlatform = 3, kTrial = 4, kSubjects = 5;
  out.Group(kPoint, "POINT");
  out.Words(kPoint, "USED", {static_cast<int>(c3d.points.size())});
  out.Words(kPoint, "FRAMES", {std::min(c3d.frames, kFull16)});
  if (c3d.frames >= kFull16) out.Real(kPoint, "LONG_FRAMES", c3d.frames);
  out.Words(kPoint, "DATA_START", {data_block});
  out.Real(kPoint, "SCALE", scale);
  out.Real(kPoint, "RATE", c3d.rate_hz);
  out.Text(kPoint, "UNITS", c3d.units);
  if (!c3d.x_screen.empty()) out.Text(kPoint, "X_SCREEN", c3d.x_screen);
  if (!c3d.y_screen.empty()) out.Text(kPoint, "Y_SCREEN", c3d.y_screen);
  std::vector<std::string> labels, descriptions;
  std::map<std::string, std::vector<std::string>> quantities;
  for (const C3dPoint& point : c3d.points) {
    labels.push_back(point.label);
    descriptions.push_back(point.description);
    if (point.quantity.empty()) continue;
    quantities[point.quantity].push_back(point.label);
  }
  out.Texts(kPoint, "LABELS", labels);
  out.Texts(kPoint, "DESCRIPTIONS", descriptions);
  std::vector<std::string> pairs;
  for (const auto& [name, of] : quantities) {
    out.Texts(kPoint, name, of);
    pairs.insert(pairs.end(), {name, name.substr(0, name.size() - 1)});
  }
  if (!pairs.empty()) out.Texts(kPoint, "TYPE_GROUPS", pairs);
  out.Group(kAnalog, "ANALOG");
  out.Words(kAnalog, "USED", {0});
  out.Real(kAnalog, "GEN_SCALE", 1.0);
  out.Real(kAnalog, "RATE", c3d.rate_hz);
  out.Group(kPlatform, "FORCE_PLATFORM");
  out.Words(kPlatform, "USED", {0});
  out.Group(kTrial, "TRIAL");
  const int last = c3d.first_frame + c3d.frames - 1;
  out.Words(kTrial, "ACTUAL_START_FIELD", {c3d.first_frame & kFull16, c3d.first_frame >> 16});
  out.Words(kTrial, "ACTUAL_END_FIELD", {last & kFull16, last >> 16});
  if (!c3d.subjects.empty()) {
    out.Group(kSubjects, "SUBJECTS");
    out.Words(kSubjects, "USED", {static_cast<int>(c3d.subjects.size())});
    out.Texts(kSubjects, "NAMES", c3d.subjects);
  }
  out.Byte(0);
  out.Byte(0);
  out.FillBlock();
  return out.bytes;
}

}  // namespace

Expected<std::string> WriteC3d(const C3dFile& c3d, const std::string& name) {
  if (c3d.points.empty() || c3d.points.size() > kFull16 / 4) {
    return Fail(ErrorCode::kUnsupported,
                Counted(static_cast<long long>(c3d.points.size()), "point") + ", a C3D file has 1 to 16383", name);
  }
  double most = 0.0;
  for (const double value : c3d.values) most = std::max(most, std::abs(value));
  const double step = static_cast<double>(static_cast<float>(std::max(most, 1e-6) / kStepsOfIntegers));
  const double scale = c3d.floats ? -std::max(c3d.scale, 1e-6) : step;
  std::string parameters = ParametersOf(c3d, scale, 0, 0);
  const std::size_t blocks = parameters.size() / kBlockBytes;
  if (blocks > kMostBlocks) {
    return Fail(ErrorCode::kUnsupported, "labels and descriptions take more than 255 blocks of 512 bytes", name,
                "write fewer points, or shorter names");
  }
  const int data_block = static_cast<int>(2 + blocks);
  parameters = ParametersOf(c3d, scale, data_block, blocks);
  C3dBytes out(c3d.processor);
  out.Byte(2);
  out.Byte(0x50);
  out.Word(static_cast<int>(c3d.points.size()));
  out.Word(0);  // analogue samples of a frame
  out.Word(std::min(c3d.first_frame, kFull16));
  out.Word(std::min(c3d.first_frame + c3d.frames - 1, kFull16));
  out.Word(0);  // frames that were interpolated
  out.Float(scale);
  out.Word(data_block);
  out.Word(0);  // analogue samples of a channel in a frame
  out.Float(c3d.rate_hz);
  out.FillBlock();
  out.bytes += parameters;
  const std::size_t number = c3d.floats ? 4 : 2;
  out.bytes.reserve(out.bytes.size() + c3d.residual.size() * 4 * number + kBlockBytes);
  for (std::size_t i = 0; i < c3d.residual.size(); ++i) {
    const bool seen = c3d.residual[i] >= 0.0F;
    for (std::size_t k = 0; k < 3; ++k) {
      const double value = seen ? c3d.values[3 * i + k] : 0.0;
      c3d.floats ? out.Float(value) : out.Word(static_cast<int>(std::lround(value / scale)));
    }
    const double residual = std::min(255.0, std::round(static_cast<double>(c3d.residual[i]) / std::abs(scale)));
    const int fourth = seen ? static_cast<int>(residual) : -1;
    c3d.floats ? out.Float(fourth) : out.Word(fourth);
  }
  out.FillBlock();
  return std::move(out.bytes);
}

}  // namespace mocurate
