#include "core/formats/amass.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "core/base/text.h"
#include "core/formats/array_elements.h"
#include "core/formats/array_fields.h"
#include "core/formats/npz.h"

namespace mocurate {
namespace {

/// Numbers of a motion that are not finite or implausibly large, by frame.
struct DamagedPoses {
  std::map<int, long long> in_frame;  ///< how many
  std::map<int, std::string> first;   ///< the first of a frame: "poses[12, 3] is NaN"
};

bool IsSound(double value) { return std::isfinite(value) && std::abs(value) <= kLargestNumber; }

/// Arrays of one row a frame that make the motion.
std::vector<NpzMember*> MotionArrays(Npz& npz) {
  std::vector<NpzMember*> arrays;
  for (NpzMember& member : npz.members) {
    const NpyArray& array = member.array;
    const bool motion = member.name == "poses" || member.name == "trans" || member.name == "root_orient" ||
                        member.name.rfind("pose_", 0) == 0;
    const bool rows = array.shape.size() == 2 && array.values.size() == array.shape[0] * array.shape[1];
    if (motion && rows) arrays.push_back(&member);
  }
  return arrays;
}

/// Sets frames that hold one of these numbers to 0, in all arrays of the motion.
DamagedPoses ClearDamaged(Npz& npz) {
  DamagedPoses damaged;
  for (const NpzMember* member : MotionArrays(npz)) {
    const std::vector<double>& values = member->array.values;
    for (std::size_t at = 0, wide = member->array.shape[1]; at < values.size(); ++at) {
      if (IsSound(values[at])) continue;
      const auto frame = static_cast<int>(at / wide);
      ++damaged.in_frame[frame];
      damaged.first.emplace(frame, member->name + "[" + std::to_string(frame) + ", " + std::to_string(at % wide) +
                                       "] is " + (std::isnan(values[at]) ? "NaN" : FormatDouble(values[at])));
    }
  }
  for (NpzMember* member : MotionArrays(npz)) {
    const auto wide = static_cast<std::ptrdiff_t>(member->array.shape[1]);
    for (const auto& [frame, numbers] : damaged.in_frame) {
      if (static_cast<std::size_t>(frame) >= member->array.shape[0]) continue;
      std::fill_n(member->array.values.begin() + frame * wide, wide, 0.0);
    }
  }
  return damaged;
}

/// Fills `damaged` and `findings`.
void ReportDamaged(const DamagedPoses& damaged, const std::string& name, Amass& amass) {
  constexpr std::size_t kMostFindings = 200;
  for (const auto& [frame, numbers] : damaged.in_frame) {
    const bool follows = !amass.damaged.empty() && amass.damaged.back() + 1 == frame;
    amass.damaged.push_back(frame);
    if (follows && !amass.findings.empty() && amass.findings.back().frame_end == frame) {
      amass.findings.back().frame_end = frame + 1;
      amass.findings.back().value += static_cast<double>(numbers);
      continue;
    }
    if (amass.findings.size() >= kMostFindings) continue;
    amass.findings.push_back(FindingOfFrames("not_a_number", frame, frame + 1, static_cast<double>(numbers),
                                             damaged.first.at(frame), FindingAction::kDropped));
  }
  for (Finding& finding : amass.findings) {
    finding.message = name + ": " + Counted(static_cast<long long>(finding.value), "number") + " of " +
                      Counted(finding.frame_end - finding.frame_begin, "frame") +
                      (finding.value > 1.0 ? " are implausible, the first: " : " is implausible: ") + finding.message;
  }
}

struct Part {
  const char* key;
  std::size_t columns;
};

constexpr Part kBodyAndHands[] = {{"root_orient", 3}, {"pose_body", 63}, {"pose_hand", 90}};
constexpr Part kWhole[] = {{"root_orient", 3}, {"pose_body", 63}, {"pose_jaw", 3}, {"pose_eye", 6}, {"pose_hand", 90}};

std::vector<Part> PartsOf(std::size_t columns) {
  if (columns == 165) return {std::begin(kWhole), std::end(kWhole)};
  std::vector<Part> parts(std::begin(kBodyAndHands), std::end(kBodyAndHands));
  if (columns == 66) parts.pop_back();
  return parts;
}

class AmassReader {
 public:
  AmassReader(const Npz& npz, const std::string& name) : npz_(npz), name_(name) {}

  Expected<Amass> Read() {
    if (Status s = CheckAxes(); !s) return Forward(s);
    if (Status s = CheckCounts(); !s) return Forward(s);
    if (Status s = Poses(); !s) return Forward(s);
    const std::size_t n = amass_.frames;
    if (Status s = Take("trans", {n, 3}, true, amass_.translation_m); !s) return Forward(s);
    if (Status s = Betas(); !s) return Forward(s);
    if (Status s = Rate(); !s) return Forward(s);
    if (Status s = TakeText("gender", amass_.gender); !s) return Forward(s);
    if (Status s = TakeText("surface_model_type", amass_.surface_model); !s) return Forward(s);
    std::vector<double> dmpls;  // not used
    if (Status s = Take("dmpls", {n, kAnyExtent}, false, dmpls); !s) return Forward(s);
    const NpyArray* markers = npz_.Find("marker_data");  // not used
    if (markers != nullptr && markers->shape.size() == 3) amass_.markers = markers->shape[1];
    return std::move(amass_);
  }

 private:
  std::string Where(const std::string& key) const { return name_ + ":" + key; }
  tl::unexpected<Error> Bad(const std::string& key, const std::string& what, ErrorCode code = ErrorCode::kMalformed,
                            const std::string& hint = "correct the array, or exclude the file") const {
    return Fail(code, what, Where(key), hint);
  }

  /// Arrays with one row per frame must have equal row counts. The error names an array that differs from at least two
  /// others.
  Status CheckCounts() const {
    std::string counts, odd;
    std::map<std::size_t, std::vector<std::string>> keys;
    for (const char* key :
         {"poses", "root_orient", "pose_body", "pose_hand", "pose_jaw", "pose_eye", "trans", "dmpls", "marker_data"}) {
      const NpyArray* array = npz_.Find(key);
      if (array == nullptr || array->shape.size() < 2) continue;
      counts += (counts.empty() ? "" : ", ") + ("'" + std::string(key) + "' has ") + std::to_string(array->shape[0]);
      keys[array->shape[0]].emplace_back(key);
    }
    if (keys.size() < 2) return {};
    const std::vector<std::string>& fewer = keys.begin()->second;
    const std::vector<std::string>& more = keys.rbegin()->second;
    if (keys.size() == 2 && fewer.size() == 1 && more.size() > 1) odd = fewer.front();
    if (keys.size() == 2 && more.size() == 1 && fewer.size() > 1) odd = more.front();
    return Fail(ErrorCode::kInconsistent, "the arrays disagree about the number of frames: " + counts,
                odd.empty() ? name_ : Where(odd),
                (odd.empty() ? "one of them" : "'" + odd + "'") +
                    " is cut off, or of another motion: export the file " + "again, or cut all to the same frames");
  }

  static bool IsKnown(std::size_t columns) {
    return columns == 66 || columns == 72 || columns == 156 || columns == 165;
  }

  /// Suggests the numpy operation that restores `poses` where it has a transposed or unflattened shape.
  Status CheckAxes() const {
    const NpyArray* poses = npz_.Find("poses");
    if (poses == nullptr || !poses->texts.empty()) return {};
    const std::vector<std::size_t>& shape = poses->shape;
    std::string way;
    if (shape.size() == 2 && !IsKnown(shape[1]) && IsKnown(shape[0])) way = "its axes are exchanged: numpy's poses.T";
    if (shape.size() == 3 && shape[2] == 3 && IsKnown(3 * shape[1])) way = "numpy's poses.reshape(len(poses), -1)";
    if (way.empty()) return {};
    return Bad("poses", "numbers of shape " + ShapeText(shape) + " where (frames, 66, 72, 156 or 165) are expected",
               ErrorCode::kInconsistent, way + " corrects it");
  }

  Status Take(const char* key, const std::vector<std::size_t>& shape, bool needed, std::vector<double>& values) {
    const NpyArray* array = npz_.Find(key);
    if (array == nullptr) {
      return needed
                 ? Status(Bad(key, "the array is missing", ErrorCode::kMalformed, "download or export the file again"))
                 : Status{};
    }
    if (Status s = CheckField(*array, shape, Where(key)); !s) return s;
    values = array->values;
    return {};
  }

  /// Some exporters leave an axis of one person before them.
  Status Betas() {
    const NpyArray* betas = npz_.Find("betas");
    const bool one = betas != nullptr && betas->shape.size() == 2 && betas->shape[0] == 1;
    return one ? Take("betas", {1, kAnyExtent}, true, amass_.betas) : Take("betas", {kAnyExtent}, true, amass_.betas);
  }

  Status TakeText(const char* key, std::string& text) {
    const NpyArray* array = npz_.Find(key);
    if (array == nullptr) return {};
    if (array->texts.size() != 1) return Bad(key, "one text is expected");
    std::string_view trimmed = Trim(array->texts[0]);
    // Some files hold the way Python prints bytes.
    if (trimmed.size() > 3 && trimmed.substr(0, 2) == "b'" && trimmed.back() == '\'') {
      trimmed = trimmed.substr(2, trimmed.size() - 3);
    }
    for (const char c : trimmed) {
      if (c < ' ' || c > '~') return Bad(key, "the text holds a character that is not printable ASCII");
    }
    text = std::string(trimmed);
    std::transform(text.begin(), text.end(), text.begin(),
                   [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
    if (std::string_view(key) == "gender" && text != "male" && text != "female" && text != "neutral") {
      return Bad(key, "'" + text + "' is not one of male, female, neutral", ErrorCode::kMalformed,
                 "write 'neutral' where it is not known");
    }
    return {};
  }

  Status Rate() {
    const NpyArray* rate = nullptr;
    for (const char* key : {"mocap_framerate", "mocap_frame_rate"}) {
      const NpyArray* array = npz_.Find(key);
      if (array == nullptr) continue;
      if (array->values.size() != 1) return Bad(key, "one number is expected");
      const double hz = array->values[0];
      if (!(hz > 0.0 && hz <= 10000.0))
        return Bad(key, FormatDouble(hz) + " is not a frame rate in Hz", ErrorCode::kMalformed,
                   "write the frames per second, above 0 and up to 10000");
      if (rate != nullptr && rate->values != array->values) {
        return Bad(key, "the rate differs from that of 'mocap_framerate'", ErrorCode::kInconsistent);
      }
      rate = array;
      amass_.rate_hz = hz;
    }
    if (rate == nullptr) {
      return Bad("mocap_framerate", "the rate is missing, under this key and 'mocap_frame_rate'", ErrorCode::kMalformed,
                 "add it to the archive: frames per second, one number");
    }
    const NpyArray* length = npz_.Find("mocap_time_length");
    if (length == nullptr) return {};
    if (length->values.size() != 1 || !std::isfinite(length->values[0])) {
      return Bad("mocap_time_length", "one number is expected");
    }
    const double seconds = static_cast<double>(amass_.frames) / amass_.rate_hz;
    if (std::abs(length->values[0] - seconds) > 0.1 + 0.02 * seconds) {
      return Bad("mocap_time_length",
                 FormatDouble(length->values[0]) + " s, but " + std::to_string(amass_.frames) + " frames at " +
                     FormatDouble(amass_.rate_hz) + " Hz last " + FormatDouble(seconds) + " s",
                 ErrorCode::kInconsistent);
    }
    return {};
  }

  Status Poses() {
    const NpyArray* whole = npz_.Find("poses");
    const NpyArray* root = npz_.Find("root_orient");
    const bool moves = npz_.Find("trans") != nullptr &&
                       (npz_.Find("mocap_framerate") != nullptr || npz_.Find("mocap_frame_rate") != nullptr);
    if (whole == nullptr && root == nullptr && moves) {
      std::string there;
      for (const NpzMember& member : npz_.members) there += (there.empty() ? "" : ", ") + member.name;
      return Fail(ErrorCode::kMalformed, "there is 'trans' and a frame rate, but neither 'poses' nor 'root_orient'",
                  Where("poses"), "it has " + there);
    }
    if (whole == nullptr && root == nullptr) {
      return Fail(ErrorCode::kUnsupported, "the file holds no motion: neither 'poses' nor 'root_orient'", name_,
                  "shape.npz and *_stagei.npz lie beside the motions and hold no motion");
    }
    if (whole != nullptr) {
      if (Status s = CheckField(*whole, {kAnyExtent, kAnyExtent}, Where("poses")); !s) return s;
      const std::size_t columns = whole->shape[1];
      if (!IsKnown(columns)) {
        return Bad("poses", std::to_string(columns) + " columns; known are 66, 72, 156 (SMPL+H) and 165 (SMPL-X)");
      }
      amass_.frames = whole->shape[0];
      amass_.pose_columns = columns;
      amass_.poses = whole->values;
    } else {
      amass_.frames = root->shape.empty() ? 0 : root->shape[0];
      amass_.pose_columns = npz_.Find("pose_jaw") != nullptr ? 165 : npz_.Find("pose_hand") != nullptr ? 156 : 66;
    }
    if (amass_.frames == 0) return Bad(whole != nullptr ? "poses" : "root_orient", "the motion has no frames");
    if (root == nullptr) return {};
    amass_.layout = Amass::Layout::kSplit;
    return Split(whole != nullptr);
  }

  /// Columns from the split keys; when `poses` is there as well, both must agree.
  Status Split(bool has_whole) {
    const std::size_t n = amass_.frames, wide = amass_.pose_columns;
    if (!has_whole) amass_.poses.assign(n * wide, 0.0);
    std::size_t first = 0;
    for (const Part& part : PartsOf(wide)) {
      const NpyArray* array = npz_.Find(part.key);
      if (array == nullptr) {
        if (!has_whole) return Bad(part.key, "the array is missing");
        first += part.columns;
        continue;
      }
      if (Status s = CheckField(*array, {n, part.columns}, Where(part.key)); !s) return s;
      for (std::size_t f = 0; f < n; ++f) {
        for (std::size_t c = 0; c < part.columns; ++c) {
          double& pose = amass_.poses[f * wide + first + c];
          const double value = array->values[f * part.columns + c];
          if (has_whole && std::abs(pose - value) > 1e-5) {
            return Bad(part.key, "frame " + std::to_string(f) + " differs from 'poses'", ErrorCode::kInconsistent);
          }
          if (!has_whole) pose = value;
        }
      }
      first += part.columns;
    }
    return {};
  }

  const Npz& npz_;
  const std::string& name_;
  Amass amass_;
};

}  // namespace

Expected<Amass> ParseAmass(std::string_view bytes, const std::string& name, DamagedRows damaged) {
  Expected<Npz> npz = ParseNpz(bytes, name);
  if (!npz) return Forward(npz);
  const DamagedPoses numbers = damaged == DamagedRows::kReport ? ClearDamaged(*npz) : DamagedPoses();
  Expected<Amass> amass = AmassReader(*npz, name).Read();
  if (!amass && !npz->unsafe.empty()) return tl::unexpected<Error>(npz->unsafe.front());
  if (!amass) return amass;
  for (const Error& unsafe : npz->unsafe) amass->findings.push_back(UnsafeMember(unsafe));
  ReportDamaged(numbers, name, *amass);
  if (amass->damaged.size() == amass->frames) {
    return Fail(ErrorCode::kMalformed,
                "every frame holds an implausible number; the first: " + numbers.first.begin()->second, name,
                "exclude the file");
  }
  return amass;
}

Expected<std::string> EncodeAmass(const Amass& amass, const std::string& name) {
  Npz npz;
  const auto add = [&](const char* key, NpyArray array) { npz.members.push_back({key, std::move(array), ""}); };
  const bool split = amass.layout == Amass::Layout::kSplit;
  const std::size_t n = amass.frames, wide = amass.pose_columns;
  if (amass.poses.size() != n * wide) {
    return Fail(ErrorCode::kInconsistent, "the poses are not frames x columns", name);
  }
  add("poses", MakeArray({n, wide}, amass.poses));
  std::size_t first = 0;
  for (const Part& part : split ? PartsOf(wide) : std::vector<Part>()) {
    std::vector<double> values;
    for (std::size_t f = 0; f < n; ++f) {
      const auto row = amass.poses.begin() + static_cast<std::ptrdiff_t>(f * wide + first);
      values.insert(values.end(), row, row + static_cast<std::ptrdiff_t>(part.columns));
    }
    add(part.key, MakeArray({n, part.columns}, std::move(values)));
    first += part.columns;
  }
  add("trans", MakeArray({n, 3}, amass.translation_m));
  add("betas", MakeArray({amass.betas.size()}, amass.betas));
  add(split ? "mocap_frame_rate" : "mocap_framerate", MakeArray({}, {amass.rate_hz}));
  if (!amass.gender.empty()) add("gender", MakeTextArray(amass.gender));
  if (!amass.surface_model.empty()) add("surface_model_type", MakeTextArray(amass.surface_model));
  return EncodeNpz(npz, name);
}

}  // namespace mocurate
