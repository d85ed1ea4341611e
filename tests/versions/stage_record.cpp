#include "tests/versions/stage_record.h"

#include <algorithm>
#include <cmath>
#include <regex>

#include "core/base/file.h"
#include "core/base/sha256.h"
#include "core/store/hdf5_file.h"

namespace mocurate::versions {
namespace {

constexpr std::size_t kFewNumbers = 6;  ///< arrays up to here are recorded as they are
constexpr std::size_t kShortText = 200;
constexpr double kZero = 1e-9;  ///< numbers this close are equal whatever their size

/// Between -1 and 1, different for each position.
double WeightOf(std::size_t place) {
  std::uint64_t z = (place + 1) * 0x9E3779B97F4A7C15ULL;
  z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ULL;
  z = (z ^ (z >> 27)) * 0x94D049BB133111EBULL;
  return static_cast<double>(z >> 11) / 4503599627370496.0 - 1.0;  // 53 bits over 2^52
}

template <class T>
nlohmann::json Figures(const std::vector<T>& values) {
  double sum = 0.0;
  double squares = 0.0;
  double mix = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const auto value = static_cast<double>(values[i]);
    sum += value;
    squares += value * value;
    mix += WeightOf(i) * value;
  }
  const double count = std::max<double>(1.0, static_cast<double>(values.size()));
  return {{"count", values.size()},
          {"mean", sum / count},
          {"rms", std::sqrt(squares / count)},
          {"mix", mix / std::sqrt(count)}};
}

/// A hash of another artifact's bytes: they depend on the CPU where a network was trained.
bool IsHash(const nlohmann::json& value) {
  if (!value.is_string()) return false;
  const std::string& text = value.get_ref<const std::string&>();
  return text.size() == 64 && text.find_first_not_of("0123456789abcdef") == std::string::npos;
}

bool Excluded(const std::string& name) {
  return name.find("sha256") != std::string::npos || name.find("created_by") != std::string::npos;
}

/// Images inside a page are bytes of another library: only their presence is recorded.
std::string WithoutPictures(const std::string& text) {
  static const std::string kMark = ";base64,";
  std::string kept;
  std::size_t from = 0;
  for (std::size_t at = text.find(kMark); at != std::string::npos; at = text.find(kMark, from)) {
    kept.append(text, from, at + kMark.size() - from);
    from =
        text.find_first_not_of("ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/=", at + kMark.size());
    if (from == std::string::npos) return kept;
  }
  return kept.append(text, from);
}

nlohmann::json RecordText(const std::string& bytes) {
  const nlohmann::json parsed = nlohmann::json::parse(bytes, nullptr, false);
  if (parsed.is_object() || parsed.is_array()) return RecordJson(parsed);
  const std::string text = WithoutPictures(bytes);
  static const std::regex kDecimal("-?[0-9]+\\.[0-9]+(e-?[0-9]+)?");
  std::string wording;
  std::vector<double> numbers;
  auto end = text.begin();
  for (std::sregex_iterator it(text.begin(), text.end(), kDecimal), none; it != none; ++it) {
    wording.append(end, text.begin() + it->position());
    wording += '#';
    numbers.push_back(std::stod(it->str()));
    end = text.begin() + it->position() + it->length();
  }
  wording.append(end, text.end());
  if (numbers.empty() && wording.size() <= kShortText) return wording;
  nlohmann::json record = {{"wording", wording.size() <= kShortText ? wording : Sha256Hex(wording)}};
  if (numbers.size() <= kFewNumbers) {
    record["numbers"] = numbers;
  } else {
    record["numbers"] = Figures(numbers);
  }
  return record;
}

bool AllNumbers(const nlohmann::json& array) {
  return std::all_of(array.begin(), array.end(), [](const nlohmann::json& value) { return value.is_number(); });
}

nlohmann::json RecordArray(const store::Array& array) {
  nlohmann::json record = {{"type", store::Name(array.type())}, {"shape", array.shape}};
  std::visit(
      [&](const auto& values) {
        using T = typename std::decay_t<decltype(values)>::value_type;
        if constexpr (std::is_same_v<T, std::string>) {
          record["values"] = nlohmann::json::array();
          for (const std::string& text : values) record["values"].push_back(RecordText(text));
        } else {
          record["values"] = values.size() <= kFewNumbers ? nlohmann::json(values) : Figures(values);
        }
      },
      array.values);
  return record;
}

Expected<nlohmann::json> RecordHdf5(const std::filesystem::path& artifact) {
  const auto reader = store::Hdf5Reader::Open(artifact);
  if (!reader) return Forward(reader);
  nlohmann::json record = nlohmann::json::object();
  const auto paths = reader->AllPaths();
  if (!paths) return Forward(paths);
  for (const std::string& path : *paths) {
    if (Excluded(path)) continue;
    Expected<store::Array> read = Fail(ErrorCode::kUnsupported, "a field of no known type", path);
    for (const store::FieldType type : {store::FieldType::kText, store::FieldType::kFloat32, store::FieldType::kFloat64,
                                        store::FieldType::kInt32, store::FieldType::kInt64, store::FieldType::kUint8}) {
      if (!read) read = reader->Read(path, type);
    }
    if (!read) return Forward(read);
    record[path] = RecordArray(*read);
  }
  return record;
}

bool AreFigures(const nlohmann::json& value) { return value.is_object() && value.contains("rms"); }

void Compare(const nlohmann::json& expected, const nlohmann::json& actual, double tolerance, const std::string& place,
             std::vector<std::string>& differences) {
  const auto differ = [&] {
    differences.push_back((place.empty() ? "/" : place) + ": " + expected.dump() + " is recorded, now " +
                          actual.dump());
  };
  if (expected.is_number() && actual.is_number()) {
    const auto a = expected.get<double>();
    const auto b = actual.get<double>();
    if (std::abs(a - b) > kZero + tolerance * std::max(std::abs(a), std::abs(b))) differ();
  } else if (AreFigures(expected) && AreFigures(actual)) {
    const double allowed = kZero + tolerance * expected["rms"].get<double>();
    bool same = expected["count"] == actual["count"];
    for (const char* figure : {"mean", "rms", "mix"}) {
      same = same && std::abs(expected[figure].get<double>() - actual[figure].get<double>()) <= allowed;
    }
    if (!same) differ();
  } else if (expected.is_object() && actual.is_object()) {
    for (const auto& [key, value] : expected.items()) {
      Compare(value, actual.contains(key) ? actual[key] : nlohmann::json(), tolerance, place + "/" + key, differences);
    }
    for (const auto& [key, value] : actual.items()) {
      if (!expected.contains(key)) Compare(nlohmann::json(), value, tolerance, place + "/" + key, differences);
    }
  } else if (expected.is_array() && actual.is_array() && expected.size() == actual.size()) {
    for (std::size_t i = 0; i < expected.size(); ++i) {
      Compare(expected[i], actual[i], tolerance, place + "/" + std::to_string(i), differences);
    }
  } else if (expected != actual) {
    differ();
  }
}

}  // namespace

nlohmann::json RecordJson(const nlohmann::json& value) {
  if (value.is_string()) return RecordText(value.get<std::string>());
  if (value.is_array()) {
    if (value.size() > kFewNumbers && AllNumbers(value)) return Figures(value.get<std::vector<double>>());
    nlohmann::json record = nlohmann::json::array();
    for (const nlohmann::json& element : value) record.push_back(RecordJson(element));
    return record;
  }
  if (!value.is_object()) return value;
  nlohmann::json record = nlohmann::json::object();
  for (const auto& [key, member] : value.items()) {
    if (!Excluded(key) && !IsHash(member)) record[key] = RecordJson(member);
  }
  return record;
}

Expected<nlohmann::json> RecordArtifact(const std::filesystem::path& artifact) {
  if (std::filesystem::is_directory(artifact)) {
    nlohmann::json files = nlohmann::json::object();
    for (const auto& entry : std::filesystem::directory_iterator(artifact)) {
      const auto page = entry.path().extension() == ".html" ? RecordArtifact(entry.path())
                                                            : Expected<nlohmann::json>(entry.file_size());
      if (!page) return Forward(page);
      files[entry.path().filename().string()] = *page;
    }
    return files;
  }
  const auto bytes = ReadFile(artifact);
  if (!bytes) return Forward(bytes);
  if (bytes->rfind("\x89HDF", 0) == 0) return RecordHdf5(artifact);
  if (bytes->find('\0') == std::string::npos) return RecordText(*bytes);
  return nlohmann::json{{"kind", Sha256Hex(bytes->substr(0, 24))}};  // of a picture: that it is one, and its size
}

std::vector<std::string> Differences(const nlohmann::json& expected, const nlohmann::json& actual, double tolerance) {
  std::vector<std::string> differences;
  Compare(expected, actual, tolerance, "", differences);
  return differences;
}

}  // namespace mocurate::versions
