#include "core/formats/c3d.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <map>
#include <optional>
#include <utility>

#include "core/base/text.h"
#include "core/formats/line_reader.h"

namespace mocurate {
namespace {

constexpr std::size_t kBlock = 512;
constexpr unsigned char kMagic = 0x50;
constexpr int kMost16 = 65535;
constexpr const char* kCopyAgain = "the file is damaged: copy it again";
constexpr const char* kWriteAgain = "write the file again with the program that made it, or with another reader";

// Numbers of each processor, from unaligned bytes.

std::uint16_t Word(const char* at, C3dProcessor processor) {
  const auto a = static_cast<unsigned char>(at[0]), b = static_cast<unsigned char>(at[1]);
  return static_cast<std::uint16_t>(processor == C3dProcessor::kSgi ? a << 8 | b : b << 8 | a);
}

float FloatOfBits(std::uint32_t bits) {
  float value = 0.0F;
  std::memcpy(&value, &bits, sizeof(value));
  return value;
}

/// A VAX F float is an IEEE float of a quarter, with its halves exchanged.
float FloatAt(const char* at, C3dProcessor processor) {
  const std::uint32_t first = Word(at, processor), second = Word(at + 2, processor);
  if (processor == C3dProcessor::kIntel) return FloatOfBits(second << 16 | first);
  const float value = FloatOfBits(first << 16 | second);
  return processor == C3dProcessor::kDec ? value / 4.0F : value;
}

/// A value of the parameter section.
struct Parameter {
  int type = 0;  ///< -1 text, 1 byte, 2 integer, 4 float
  std::vector<std::size_t> extents;
  std::string_view data;
  C3dProcessor processor = C3dProcessor::kIntel;

  std::size_t bytes_each() const { return type < 0 ? 1 : static_cast<std::size_t>(type); }
  std::size_t size() const { return data.size() / bytes_each(); }

  /// A number; integers as counts, which are not negative.
  std::optional<double> Number(std::size_t index = 0) const {
    if (type < 0 || index >= size()) return std::nullopt;
    const char* at = data.data() + index * bytes_each();
    const double value = type == 4   ? static_cast<double>(FloatAt(at, processor))
                         : type == 2 ? static_cast<double>(Word(at, processor))
                                     : static_cast<double>(static_cast<unsigned char>(*at));
    return std::isfinite(value) ? std::optional(value) : std::nullopt;
  }

  /// Texts of the first extent's length each, without blanks and NULs around them.
  std::vector<std::string> Texts() const {
    std::vector<std::string> texts;
    if (type >= 0 || data.empty()) return texts;
    const std::size_t length = extents.empty() ? 1 : extents.front();
    for (std::size_t at = 0; at + length <= data.size(); at += length) {
      std::string_view text = data.substr(at, length);
      text = text.substr(0, text.find('\0'));
      texts.emplace_back(Trim(text));
    }
    return texts;
  }
};

std::string Upper(std::string_view text) {
  std::string upper(text);
  for (char& c : upper) c = c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
  return upper;
}

class C3dReader {
 public:
  C3dReader(std::string_view bytes, const std::string& name, DamagedRows damaged_rows)
      : bytes_(bytes), name_(name), damaged_rows_(damaged_rows) {}

  Expected<C3dFile> Run() {
    if (Status read = Sections(); !read) return Forward(read);
    if (Status read = Parameters(); !read) return Forward(read);
    if (Status read = Points(); !read) return Forward(read);
    if (Status read = Samples(); !read) return Forward(read);
    if (Status read = Frames(); !read) return Forward(read);
    return std::move(c3d_);
  }

 private:
  tl::unexpected<Error> Bad(std::string what, const std::string& where, std::string hint = kCopyAgain) const {
    return Fail(ErrorCode::kMalformed, std::move(what), name_ + ": " + where, std::move(hint));
  }
  tl::unexpected<Error> Contradiction(std::string what, const std::string& where) const {
    return Fail(ErrorCode::kInconsistent, std::move(what), name_ + ": " + where, kWriteAgain);
  }
  const char* At(std::size_t byte) const { return bytes_.data() + byte; }
  int HeaderWord(std::size_t number) const { return Word(At(2 * (number - 1)), c3d_.processor); }
  double HeaderFloat(std::size_t number) const { return FloatAt(At(2 * (number - 1)), c3d_.processor); }

  Status Sections() {
    if (bytes_.size() < 2 || static_cast<unsigned char>(bytes_[1]) != kMagic)
      return Bad("the second byte is not 50 (hexadecimal): no C3D", "header", "");
    if (bytes_.size() < 2 * kBlock)
      return Bad("the file has " + Counted(static_cast<long long>(bytes_.size()), "byte") +
                     ", header and parameters take at least 1024",
                 "header");
    parameters_ = static_cast<unsigned char>(bytes_[0]);
    if (parameters_ < 2 || (parameters_ - 1) * kBlock + 4 > bytes_.size()) {
      return Bad("parameters begin in block " + std::to_string(parameters_) + ", the file has blocks 1 to " +
                     std::to_string((bytes_.size() + kBlock - 1) / kBlock),
                 "header");
    }
    const int processor = static_cast<unsigned char>(bytes_[(parameters_ - 1) * kBlock + 3]);
    if (processor < 84 || processor > 86) {
      return Fail(ErrorCode::kUnsupported,
                  "processor " + std::to_string(processor) + ", known are 84 (Intel), 85 (DEC) and 86 (SGI)",
                  name_ + ": parameters", kCopyAgain);
    }
    c3d_.processor = static_cast<C3dProcessor>(processor);
    return {};
  }

  /// Groups and parameters are a chain of records, which ends with an empty name or an offset of 0.
  Status Parameters() {
    struct Record {
      int group;
      std::string name;
      Parameter parameter;
    };
    std::map<int, std::string> groups;
    std::vector<Record> records;
    std::size_t at = (parameters_ - 1) * kBlock + 4;
    std::string last = "the parameter section";
    while (true) {
      if (at + 2 > bytes_.size()) return Bad("the parameters go on behind the end of the file", last);
      const int length = std::abs(static_cast<int>(static_cast<signed char>(bytes_[at])));
      const int group = static_cast<signed char>(bytes_[at + 1]);
      if (length == 0 || group == 0) break;
      const std::size_t offset_at = at + 2 + static_cast<std::size_t>(length);
      if (offset_at + 2 > bytes_.size()) return Bad("the parameters go on behind the end of the file", last);
      const std::string called = Upper(bytes_.substr(at + 2, static_cast<std::size_t>(length)));
      last = Shown(called);
      const std::size_t offset = Word(At(offset_at), c3d_.processor);
      const std::size_t next = offset_at + offset;
      if (group < 0) {
        groups[-group] = called;
      } else {
        auto parameter = ReadParameter(offset_at + 2, offset == 0 ? bytes_.size() : next, last);
        if (!parameter) return Forward(parameter);
        records.push_back({group, called, std::move(*parameter)});
      }
      if (offset == 0) break;
      if (offset < 3) return Bad("the next record begins within this one", last);
      at = next;
    }
    for (Record& record : records) {
      const auto group = groups.find(record.group);
      const std::string key = (group == groups.end() ? "" : group->second) + ":" + record.name;
      const auto [known, is_new] = known_.emplace(key, record.parameter);
      if (!is_new && known->second.data != record.parameter.data)
        return Contradiction("the parameter occurs twice, with different values", Shown(key));
    }
    return {};
  }

  Expected<Parameter> ReadParameter(std::size_t at, std::size_t end, const std::string& called) const {
    if (at + 2 > bytes_.size()) return Bad("the parameter is cut off", called);
    Parameter parameter;
    parameter.processor = c3d_.processor;
    parameter.type = static_cast<signed char>(bytes_[at]);
    if (parameter.type != -1 && parameter.type != 1 && parameter.type != 2 && parameter.type != 4)
      return Bad("type " + std::to_string(parameter.type) + ", known are -1, 1, 2 and 4", called);
    const auto dimensions = static_cast<std::size_t>(static_cast<unsigned char>(bytes_[at + 1]));
    if (at + 2 + dimensions > bytes_.size()) return Bad("the parameter is cut off", called);
    std::size_t size = parameter.bytes_each();
    for (std::size_t d = 0; d < dimensions; ++d) {
      parameter.extents.push_back(static_cast<unsigned char>(bytes_[at + 2 + d]));
      size *= parameter.extents.back();
      if (size > bytes_.size()) return Bad("the parameter is larger than the file", called);
    }
    const std::size_t begin = at + 2 + dimensions;
    if (begin + size > std::min(end, bytes_.size()))
      return Bad("its " + std::to_string(size) + " bytes reach into the next parameter", called);
    parameter.data = bytes_.substr(begin, size);
    return parameter;
  }

  const Parameter* Find(const std::string& key) const {
    const auto found = known_.find(key);
    return found == known_.end() ? nullptr : &found->second;
  }
  std::optional<double> NumberOf(const std::string& key, std::size_t index = 0) const {
    const Parameter* parameter = Find(key);
    return parameter == nullptr ? std::nullopt : parameter->Number(index);
  }
  /// Of a parameter and its continuations: LABELS, LABELS2, ...
  std::vector<std::string> TextsOf(const std::string& key) const {
    std::vector<std::string> texts;
    for (int part = 1;; ++part) {
      const Parameter* parameter = Find(part == 1 ? key : key + std::to_string(part));
      if (parameter == nullptr) return texts;
      const std::vector<std::string> more = parameter->Texts();
      texts.insert(texts.end(), more.begin(), more.end());
    }
  }
  std::string TextOf(const std::string& key) const {
    const std::vector<std::string> texts = TextsOf(key);
    return texts.empty() ? "" : texts.front();
  }

  Status Points() {
    c3d_.rotations = TextsOf("ROTATION:LABELS");
    const int count = HeaderWord(2);
    const auto used = NumberOf("POINT:USED");
    if (used && *used != count) {
      return Contradiction("the header has " + Counted(count, "point") + ", POINT:USED " + FormatDouble(*used),
                           "POINT:USED");
    }
    if (count == 0) {
      return Fail(ErrorCode::kUnsupported,
                  c3d_.rotations.empty() ? "the file has no points"
                                         : "the file has no points, only the rotations of " +
                                               Counted(static_cast<long long>(c3d_.rotations.size()), "segment") +
                                               " (group ROTATION), which are not read",
                  name_, c3d_.rotations.empty() ? "" : "export joint centres as points (Theia: in Visual3D)");
    }
    c3d_.points.resize(static_cast<std::size_t>(count));
    const std::vector<std::string> labels = TextsOf("POINT:LABELS"), descriptions = TextsOf("POINT:DESCRIPTIONS");
    std::map<std::string, std::string> quantity_of;
    for (std::string group : QuantityGroups()) {
      for (const std::string& label : TextsOf("POINT:" + group)) quantity_of[label] = group;
    }
    for (std::size_t p = 0; p < c3d_.points.size(); ++p) {
      C3dPoint& point = c3d_.points[p];
      if (p < labels.size()) point.label = labels[p];
      if (p < descriptions.size()) point.description = descriptions[p];
      const auto quantity = point.label.empty() ? quantity_of.end() : quantity_of.find(point.label);
      if (quantity != quantity_of.end()) point.quantity = quantity->second;
    }
    c3d_.units = TextOf("POINT:UNITS");
    c3d_.x_screen = Upper(TextOf("POINT:X_SCREEN"));
    c3d_.y_screen = Upper(TextOf("POINT:Y_SCREEN"));
    for (const std::string& subject : TextsOf("SUBJECTS:NAMES")) {
      if (!subject.empty()) c3d_.subjects.push_back(subject);
    }
    return {};
  }

  /// Names of the lists of what is in POINT and is no position: the first of each pair of TYPE_GROUPS, and the usual.
  std::vector<std::string> QuantityGroups() const {
    std::vector<std::string> groups = {"ANGLES", "FORCES", "MOMENTS", "POWERS", "SCALARS"};
    const std::vector<std::string> pairs = TextsOf("POINT:TYPE_GROUPS");
    for (std::size_t i = 0; i + 1 < pairs.size(); i += 2) {
      if (std::find(groups.begin(), groups.end(), Upper(pairs[i])) == groups.end()) groups.push_back(Upper(pairs[i]));
    }
    return groups;
  }

  /// Form and place of the samples.
  Status Samples() {
    const double header = HeaderFloat(7), stated = NumberOf("POINT:SCALE").value_or(0.0);
    const bool both = header != 0.0 && stated != 0.0;
    if (!std::isfinite(header) || (both && (header < 0.0) != (stated < 0.0))) {
      return Contradiction("scale " + FormatDouble(header) + " in the header, POINT:SCALE is " + FormatDouble(stated) +
                               "; a negative one means floats",
                           "POINT:SCALE");
    }
    const double scale = stated != 0.0 ? stated : header;
    c3d_.floats = scale < 0.0;
    c3d_.scale = std::abs(scale);
    if (scale == 0.0) return Bad("the scale is 0: integers have no unit", "POINT:SCALE", kWriteAgain);
    if (!c3d_.floats && both && std::abs(header - stated) > 1e-5 * c3d_.scale) {
      return Contradiction(
          "a step is " + FormatDouble(header) + " in the header, POINT:SCALE is " + FormatDouble(stated),
          "POINT:SCALE");
    }
    const int analog = HeaderWord(3), each = HeaderWord(10);
    const auto channels = NumberOf("ANALOG:USED");
    if (channels && each > 0 && *channels * each != analog) {
      return Contradiction("the header has " + Counted(analog, "analogue sample") + " a frame, ANALOG:USED tells " +
                               FormatDouble(*channels) + " channels of " + std::to_string(each),
                           "ANALOG:USED");
    }
    frame_words_ = 4 * c3d_.points.size() + static_cast<std::size_t>(analog);
    const int header_start = HeaderWord(9);
    const double stated_start = NumberOf("POINT:DATA_START").value_or(0.0);
    if (!(stated_start >= 0.0 && stated_start <= kMost16))
      return Bad("block " + FormatDouble(stated_start) + " is none of a file", "POINT:DATA_START", kWriteAgain);
    const int start = static_cast<int>(stated_start);
    if (header_start > 0 && start > 0 && header_start != start) {
      return Contradiction("samples begin in block " + std::to_string(header_start) +
                               " by the header, POINT:DATA_START is " + std::to_string(start),
                           "POINT:DATA_START");
    }
    const int block = std::max(header_start, start);
    if (block < 2) return Bad("nothing tells where samples begin", "POINT:DATA_START");
    data_begin_ = (static_cast<std::size_t>(block) - 1) * kBlock;
    data_end_ = bytes_.size();
    if (const std::size_t begin = (parameters_ - 1) * kBlock; begin > data_begin_) data_end_ = begin;
    if (data_begin_ >= data_end_)
      return Bad("samples begin in block " + std::to_string(block) + ", behind the end of the file", "header");
    return {};
  }

  std::size_t FrameBytes() const { return frame_words_ * (c3d_.floats ? 4U : 2U); }

  /// A count of 32 bits in two words.
  std::optional<long long> LongNumber(const std::string& key) const {
    const auto low = NumberOf(key), high = NumberOf(key, 1);
    if (!low || *low < 0.0 || *low > kMost16 || high.value_or(0.0) < 0.0 || high.value_or(0.0) > kMost16)
      return std::nullopt;
    return static_cast<long long>(*low + 65536.0 * high.value_or(0.0));
  }

  /// The number of frames by each field that states it; 16 bits that are full state none.
  Expected<long long> CountFrames() {
    std::vector<std::pair<const char*, long long>> stated;
    const int first = HeaderWord(4), last = HeaderWord(5);
    c3d_.first_frame = first;
    if (last >= first && last < kMost16) stated.emplace_back("the header", last - first + 1);
    const auto begin = LongNumber("TRIAL:ACTUAL_START_FIELD"), end = LongNumber("TRIAL:ACTUAL_END_FIELD");
    if (begin && end && *end >= *begin) {
      stated.emplace_back("TRIAL:ACTUAL_END_FIELD", *end - *begin + 1);
      c3d_.first_frame = static_cast<int>(std::min<long long>(*begin, 1 << 30));
    }
    for (const char* key : {"POINT:LONG_FRAMES", "POINT:FRAMES"}) {
      const double frames = NumberOf(key).value_or(0.0);
      if (frames == 0.0 || frames == kMost16) continue;
      if (!(frames >= 1.0 && frames < 1e15) || frames != std::floor(frames))
        return Bad("'" + FormatDouble(frames) + "' is no number of frames", key, kWriteAgain);
      stated.emplace_back(key, std::llround(frames));
    }
    if (stated.empty()) return Bad("nothing tells the number of frames", "header");
    const auto differs = std::find_if(stated.begin(), stated.end(),
                                      [&](const auto& other) { return other.second != stated.front().second; });
    if (differs == stated.end()) return stated.front().second;
    std::string all;
    std::vector<long long> fitting;
    for (const auto& [place, count] : stated) {
      all += (all.empty() ? "" : ", ") + std::string(place) + " " + std::to_string(count);
      if (Fills(count) && std::find(fitting.begin(), fitting.end(), count) == fitting.end()) fitting.push_back(count);
    }
    if (fitting.size() != 1) return Contradiction("the numbers of frames differ: " + all, "POINT:FRAMES");
    c3d_.findings.push_back(MakeFinding("count_contradiction", Severity::kWarning, static_cast<double>(fitting.front()),
                                        "the numbers of frames differ: " + all + "; the samples of " +
                                            std::to_string(fitting.front()) + " fill the file"));
    return fitting.front();
  }

  /// Whether so many frames end where the samples do, in the last block at most.
  bool Fills(long long count) const {
    const std::size_t room = data_end_ - data_begin_;
    if (count <= 0 || static_cast<std::size_t>(count) > room / FrameBytes()) return false;
    return room - static_cast<std::size_t>(count) * FrameBytes() < kBlock;
  }

  Status Frames() {
    const auto counted = CountFrames();
    if (!counted) return Forward(counted);
    long long count = *counted;
    const auto whole = static_cast<long long>((data_end_ - data_begin_) / FrameBytes());
    if (count > whole) {
      if (damaged_rows_ == DamagedRows::kRefuse || whole == 0)
        return CountContradiction("the number of frames", static_cast<double>(count), static_cast<double>(whole),
                                  name_);
      c3d_.findings.push_back(MakeFinding(
          "cut_off", Severity::kError, static_cast<double>(count - whole),
          "the file is cut off: " + std::to_string(count) + " frames are announced, it holds " + std::to_string(whole),
          FindingAction::kDropped));
      count = whole;
    }
    c3d_.frames = static_cast<int>(count);
    Rate();
    const std::size_t samples = static_cast<std::size_t>(count) * c3d_.points.size();
    c3d_.values.resize(3 * samples);
    c3d_.residual.resize(samples);
    switch (c3d_.processor) {  // the loop is compiled for each
      case C3dProcessor::kIntel:
        return c3d_.floats ? ReadSamples<C3dProcessor::kIntel, true>() : ReadSamples<C3dProcessor::kIntel, false>();
      case C3dProcessor::kDec:
        return c3d_.floats ? ReadSamples<C3dProcessor::kDec, true>() : ReadSamples<C3dProcessor::kDec, false>();
      default:
        return c3d_.floats ? ReadSamples<C3dProcessor::kSgi, true>() : ReadSamples<C3dProcessor::kSgi, false>();
    }
  }

  void Rate() {
    const double header = HeaderFloat(11);
    const auto stated = NumberOf("POINT:RATE");
    c3d_.rate_hz = stated && *stated > 0.0 ? *stated : std::isfinite(header) && header > 0.0 ? header : 0.0;
    if (stated && *stated > 0.0 && header > 0.0 && std::abs(header - *stated) > 1e-3 * *stated) {
      c3d_.findings.push_back(MakeFinding(
          "rate_contradiction", Severity::kError, header,
          RoundedText(header, 6) + " frames a second by the header, POINT:RATE is " + RoundedText(*stated, 6)));
    }
  }

  template <C3dProcessor kProcessor, bool kFloats>
  Status ReadSamples() {
    const std::size_t step = kFloats ? 4 : 2, points = c3d_.points.size();
    const double factor = kFloats ? 1.0 : c3d_.scale;
    long long lost = 0;
    const auto number = [&](const char* at) -> double {
      if constexpr (kFloats)
        return FloatAt(at, kProcessor);
      else
        return static_cast<std::int16_t>(Word(at, kProcessor));
    };
    for (int f = 0; f < c3d_.frames; ++f) {
      const char* at = At(data_begin_ + static_cast<std::size_t>(f) * FrameBytes());
      for (std::size_t p = 0; p < points; ++p, at += 4 * step) {
        const std::size_t index = static_cast<std::size_t>(f) * points + p;
        double* place = &c3d_.values[3 * index];
        const double fourth = number(at + 3 * step);
        c3d_.residual[index] = -1.0F;
        if (fourth < 0.0) continue;
        for (std::size_t k = 0; k < 3; ++k) place[k] = factor * number(at + k * step);
        const double most = std::max({std::abs(place[0]), std::abs(place[1]), std::abs(place[2])});
        if (std::isnan(place[0] + place[1] + place[2]) || std::isnan(fourth)) {
          std::fill_n(place, 3, 0.0);
          ++lost;
          continue;
        }
        if (!(most <= kLargestCoordinate)) {
          return Bad("point " + std::to_string(p + 1) + " (" + Shown(c3d_.points[p].label) + ") in frame " +
                         std::to_string(f) + " is at " + FormatDouble(most),
                     "samples", kCoordinateHint);
        }
        // The low byte of a 16-bit integer, also where it is stored as a float; the high one is of cameras.
        const auto word = static_cast<int>(std::min(fourth, 32767.0));
        c3d_.residual[index] = static_cast<float>(c3d_.scale * (word & 0xff));
      }
    }
    if (lost > 0) {
      c3d_.findings.push_back(MakeFinding("not_a_number", Severity::kWarning, static_cast<double>(lost),
                                          Counted(lost, "sample") + " that are no numbers are missing",
                                          FindingAction::kDropped));
    }
    return {};
  }

  std::string_view bytes_;
  const std::string& name_;
  DamagedRows damaged_rows_;
  C3dFile c3d_;
  std::size_t parameters_ = 0;                 ///< block of the parameter section, from 1
  std::map<std::string, Parameter> known_;     ///< by "GROUP:NAME"
  std::size_t frame_words_ = 0;                ///< numbers of a frame
  std::size_t data_begin_ = 0, data_end_ = 0;  ///< bytes
};

}  // namespace

Expected<C3dFile> ParseC3d(std::string_view bytes, const std::string& name, DamagedRows damaged_rows) {
  return C3dReader(bytes, name, damaged_rows).Run();
}

}  // namespace mocurate
