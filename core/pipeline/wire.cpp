#include "core/pipeline/wire.h"

#include <algorithm>
#include <cstdint>

#include "core/base/file.h"
#include "core/base/json_text.h"
#include "core/base/text.h"

namespace mocurate {
namespace {

using nlohmann::json;

constexpr std::size_t kHeader = 4;
constexpr std::uint32_t kLargestMessage = 1u << 28;

std::string Escape(std::string_view bytes) {
  constexpr char kDigits[] = "0123456789ABCDEF";
  std::string text;
  text.reserve(bytes.size());
  while (!bytes.empty()) {
    const Character character = FirstCharacter(bytes);
    if (bytes[0] == '%' || character.kind == CharacterKind::kNotUtf8) {
      const auto byte = static_cast<unsigned char>(bytes[0]);
      text += {'%', kDigits[byte >> 4], kDigits[byte & 15]};
    } else {
      text += bytes.substr(0, character.bytes);
    }
    bytes.remove_prefix(character.bytes);
  }
  return text;
}

std::string Unescape(std::string_view text) {
  std::string bytes;
  bytes.reserve(text.size());
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '%' && i + 2 < text.size() && HexDigit(text[i + 1]) >= 0 && HexDigit(text[i + 2]) >= 0) {
      bytes += static_cast<char>(HexDigit(text[i + 1]) * 16 + HexDigit(text[i + 2]));
      i += 2;
    } else {
      bytes += text[i];
    }
  }
  return bytes;
}

/// The same value with `change` applied to every string and key.
template <class Change>
json WithStrings(const json& value, const Change& change) {
  if (value.is_string()) return change(value.get_ref<const std::string&>());
  if (value.is_array()) {
    json array = json::array();
    for (const json& element : value) array.push_back(WithStrings(element, change));
    return array;
  }
  if (value.is_object()) {
    json object = json::object();
    for (const auto& [key, element] : value.items()) object[change(key)] = WithStrings(element, change);
    return object;
  }
  return value;
}

bool IsPlain(std::string_view text) { return text.find('%') == std::string_view::npos && !FirstNotUtf8(text); }

/// Whether no string or key needs an escape. A request may have 100,000 inputs, which are not copied then.
bool IsPlain(const json& value) {
  if (value.is_string()) return IsPlain(std::string_view(value.get_ref<const std::string&>()));
  if (value.is_array()) return std::all_of(value.begin(), value.end(), [](const json& part) { return IsPlain(part); });
  if (!value.is_object()) return true;
  for (const auto& [key, element] : value.items()) {
    if (!IsPlain(std::string_view(key)) || !IsPlain(element)) return false;
  }
  return true;
}

/// In the order of OutcomeKind.
constexpr std::string_view kKindNames[] = {"done", "suspect", "excluded", "refused", "crashed"};

OutcomeKind KindFromName(const std::string& name) {
  const auto found = std::find(std::begin(kKindNames), std::prev(std::end(kKindNames)), name);
  return static_cast<OutcomeKind>(found - std::begin(kKindNames));
}

Error ReadError(const json& value) {
  return Error{ErrorCodeFromName(value.at("code").get<std::string>()),
               value.at("what").get<std::string>(),
               value.at("where").get<std::string>(),
               value.at("hint").get<std::string>(),
               static_cast<Reason>(value.value("reason", 0)),
               value.value("number", 0.0)};
}

}  // namespace

std::string_view Name(OutcomeKind kind) { return kKindNames[static_cast<std::size_t>(kind)]; }

std::string CanonicalText(const json& value) {
  return IsPlain(value) ? value.dump() : WithStrings(value, Escape).dump();
}

Expected<json> FromCanonicalText(std::string_view text, const std::string& name) {
  Expected<json> parsed = ParseJson(text, name);
  if (!parsed || text.find('%') == std::string_view::npos) return parsed;  // no escape: no copy
  return WithStrings(*parsed, Unescape);
}

json ToJson(const Error& error) {
  return {{"code", Name(error.code)},
          {"what", error.what},
          {"where", error.where},
          {"hint", error.hint},
          {"reason", static_cast<int>(error.reason)},
          {"number", error.number}};
}

json ToJson(const StageOutcome& outcome) {
  json value = {{"kind", Name(outcome.kind)}, {"findings", outcome.findings}, {"summary", outcome.summary}};
  if (!HasArtifact(outcome.kind)) value["error"] = ToJson(outcome.error);
  return value;
}

Expected<Error> ErrorFromJson(const json& value) {
  return GuardJson("error", [&] { return ReadError(value); });
}

Expected<StageOutcome> OutcomeFromJson(const json& value) {
  return GuardJson("outcome", [&] {
    StageOutcome outcome;
    outcome.kind = KindFromName(value.at("kind").get<std::string>());
    outcome.findings = value.at("findings").get<std::vector<Finding>>();
    outcome.summary = value.at("summary");
    if (value.contains("error")) outcome.error = ReadError(value.at("error"));
    return outcome;
  });
}

Expected<StageRequest> RequestFromJson(const json& value) {
  return GuardJson("request", [&] { return value.get<StageRequest>(); });
}

std::string Frame(const json& message) {
  std::string frame = CanonicalText(message);
  const auto size = static_cast<std::uint32_t>(frame.size());
  char header[kHeader];
  for (std::size_t i = 0; i < kHeader; ++i) header[i] = static_cast<char>((size >> (8 * i)) & 0xFF);
  frame.insert(0, header, kHeader);
  return frame;
}

Expected<std::optional<json>> TakeMessage(std::string& buffer) {
  if (buffer.size() < kHeader) return std::optional<json>();
  std::uint32_t size = 0;
  for (std::size_t i = 0; i < kHeader; ++i) {
    size |= static_cast<std::uint32_t>(static_cast<unsigned char>(buffer[i])) << (8 * i);
  }
  if (size > kLargestMessage)
    return Fail(ErrorCode::kMalformed, "message announces " + std::to_string(size) + " bytes");
  if (buffer.size() < kHeader + size) return std::optional<json>();
  Expected<json> message = FromCanonicalText(std::string_view(buffer).substr(kHeader, size), "message");
  buffer.erase(0, kHeader + size);
  if (buffer.empty()) buffer.shrink_to_fit();
  if (!message) return Forward(message);
  return std::optional<json>(*std::move(message));
}

}  // namespace mocurate
