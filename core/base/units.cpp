#include "core/base/units.h"

#include <cmath>
#include <optional>

#include "core/base/pi.h"
#include "core/base/text.h"

namespace mocurate {
namespace {

/// A decimal number or a fraction of two, "1/30".
std::optional<double> ParseRatio(std::string_view text) {
  const std::size_t slash = text.find('/');
  if (slash == std::string_view::npos) return ParseDouble(text);
  const std::optional<double> above = ParseDouble(Trim(text.substr(0, slash)));
  const std::optional<double> below = ParseDouble(Trim(text.substr(slash + 1)));
  if (!above || !below || *below == 0.0) return std::nullopt;
  return *above / *below;
}

bool StartsUnit(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '%' || (c & 0x80) != 0; }

/// Where the unit begins in "1/30 s", "30mm", "1e3 m": the last run of letters, slashes between letters and "%".
std::size_t UnitBegin(std::string_view text) {
  std::size_t begin = text.size();
  while (begin > 0 && (StartsUnit(text[begin - 1]) || text[begin - 1] == '/')) --begin;
  while (begin < text.size() && text[begin] == '/') ++begin;
  return begin;
}

tl::unexpected<Error> NotANumber(std::string_view text, Unit unit) {
  std::string wanted = "must be a number";
  if (unit != Unit::kNone) wanted += " in " + std::string(Name(unit));
  return Fail(ErrorCode::kConfig, "'" + std::string(text) + "' " + wanted, {},
              unit == Unit::kNone ? std::string() : "units here: " + SpellingsOf(unit));
}

}  // namespace

const std::vector<UnitSpelling>& UnitSpellings() {
  static const std::vector<UnitSpelling> spellings = {
      {"m", Unit::kMetre, 1, 1},
      {"dm", Unit::kMetre, 1, 10},
      {"cm", Unit::kMetre, 1, 100},
      {"mm", Unit::kMetre, 1, 1000},
      {"um", Unit::kMetre, 1, 1000000},
      {"km", Unit::kMetre, 1000, 1},
      {"in", Unit::kMetre, 254, 10000},
      {"inch", Unit::kMetre, 254, 10000},
      {"ft", Unit::kMetre, 3048, 10000},
      {"s", Unit::kSecond, 1, 1},
      {"ms", Unit::kSecond, 1, 1000},
      {"us", Unit::kSecond, 1, 1000000},
      {"ns", Unit::kSecond, 1, 1000000000},
      {"min", Unit::kSecond, 60, 1},
      {"h", Unit::kSecond, 3600, 1},
      {"d", Unit::kSecond, 86400, 1},
      {"rad", Unit::kRadian, 1, 1},
      {"mrad", Unit::kRadian, 1, 1000},
      {"deg", Unit::kRadian, kPi, 180},
      {"turn", Unit::kRadian, 2 * kPi, 1},
      {"Hz", Unit::kHertz, 1, 1},
      {"kHz", Unit::kHertz, 1000, 1},
      {"fps", Unit::kHertz, 1, 1},
      {"m/s", Unit::kMetrePerSecond, 1, 1},
      {"cm/s", Unit::kMetrePerSecond, 1, 100},
      {"mm/s", Unit::kMetrePerSecond, 1, 1000},
      {"km/h", Unit::kMetrePerSecond, 1000, 3600},
      {"rad/s", Unit::kRadianPerSecond, 1, 1},
      {"deg/s", Unit::kRadianPerSecond, kPi, 180},
      {"rpm", Unit::kRadianPerSecond, 2 * kPi, 60},
      {"px", Unit::kPixel, 1, 1},
      {"B", Unit::kByte, 1, 1},
      {"kB", Unit::kByte, 1e3, 1},
      {"MB", Unit::kByte, 1e6, 1},
      {"GB", Unit::kByte, 1e9, 1},
      {"TB", Unit::kByte, 1e12, 1},
      {"KiB", Unit::kByte, 1024, 1},
      {"MiB", Unit::kByte, 1048576, 1},
      {"GiB", Unit::kByte, 1073741824, 1},
      {"TiB", Unit::kByte, 1099511627776.0, 1},
      {"%", Unit::kNone, 1, 100},
  };
  return spellings;
}

std::string SpellingsOf(Unit unit, std::string_view separator) {
  std::vector<std::string> list;
  for (const UnitSpelling& spelling : UnitSpellings()) {
    if (spelling.unit == unit) list.emplace_back(spelling.spelling);
  }
  return JoinTexts(list, separator);
}

std::string_view Name(Unit unit) {
  constexpr std::string_view kNames[] = {"", "m", "s", "rad", "Hz", "m/s", "rad/s", "px", "B"};
  return kNames[static_cast<std::size_t>(unit)];
}

Expected<double> ParseQuantity(std::string_view text, Unit unit) {
  text = Trim(text);
  if (const std::optional<double> plain = ParseRatio(text)) {
    if (!std::isfinite(*plain)) return NotANumber(text, unit);
    return *plain;
  }
  const std::size_t begin = UnitBegin(text);
  const std::string spelling(text.substr(begin));
  const std::optional<double> number = ParseRatio(Trim(text.substr(0, begin)));
  if (spelling.empty() || !number || !std::isfinite(*number)) return NotANumber(text, unit);
  std::vector<std::string> known;
  for (const UnitSpelling& candidate : UnitSpellings()) {
    known.emplace_back(candidate.spelling);
    if (candidate.spelling != spelling) continue;
    if (candidate.unit == unit) return *number * candidate.numerator / candidate.denominator;
    if (unit == Unit::kNone) {
      return Fail(ErrorCode::kConfig, "'" + std::string(text) + "' has a unit, a plain number is expected");
    }
    return Fail(
        ErrorCode::kConfig,
        "'" + std::string(text) + "' is in " + spelling + ", which cannot be turned into " + std::string(Name(unit)),
        {}, "units here: " + SpellingsOf(unit));
  }
  if (unit == Unit::kNone) return NotANumber(text, unit);
  return Fail(ErrorCode::kConfig, "'" + std::string(text) + "': unknown unit '" + spelling + "'", {},
              "units here: " + SpellingsOf(unit));
}

std::string QuantityText(double value, Unit unit) {
  std::string text = FormatDouble(value);
  if (unit != Unit::kNone) text += " " + std::string(Name(unit));
  return text;
}

bool IsInside(double value, const Range& range) {
  return std::isfinite(value) && (!range.min || value >= *range.min) && (!range.max || value <= *range.max);
}

std::string RangeText(const Range& range, Unit unit) {
  if (range.min && range.max) return FormatDouble(*range.min) + " to " + QuantityText(*range.max, unit);
  if (range.min) return "at least " + QuantityText(*range.min, unit);
  if (range.max) return "at most " + QuantityText(*range.max, unit);
  return {};
}

}  // namespace mocurate
