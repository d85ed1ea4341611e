#include "core/store/rules.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

#include "core/base/json_text.h"
#include "core/base/text.h"
#include "core/geometry/axes.h"
#include "core/motion/motion.h"

namespace mocurate::store {
namespace {

using Problem = std::optional<std::string>;

/// "row 3" or "row 3, 2, 0": the place of a value.
std::string Place(const Array& array, std::size_t index) {
  std::string text;
  std::size_t rest = index;
  for (std::size_t d = array.shape.size(); d-- > 0;) {
    text = std::to_string(rest % array.shape[d]) + (text.empty() ? "" : ", " + text);
    rest /= array.shape[d];
  }
  return text.empty() ? "" : "[" + text + "] ";
}

/// The first number that `broken` holds for.
template <class Broken>
Problem FirstNumber(const Array& array, const Broken& broken) {
  return std::visit(
      [&](const auto& values) -> Problem {
        using Value = typename std::decay_t<decltype(values)>::value_type;
        if constexpr (!std::is_same_v<Value, std::string>) {
          for (std::size_t i = 0; i < values.size(); ++i) {
            if (broken(static_cast<double>(values[i]))) {
              return Place(array, i) + "is " + FormatDouble(static_cast<double>(values[i]));
            }
          }
        }
        return std::nullopt;
      },
      array.values);
}

template <class Broken>
Rule Numbers(std::string words, Broken broken) {
  return {std::move(words), [broken](const RuleContext& c) { return FirstNumber(c.array, broken); }};
}

template <class Broken>
Rule Texts(std::string words, Broken broken) {
  return {std::move(words), [broken](const RuleContext& c) -> Problem {
            const auto& texts = c.array.as<std::string>();
            for (std::size_t i = 0; i < texts.size(); ++i) {
              if (broken(texts[i])) return Place(c.array, i) + "is '" + texts[i].substr(0, 200) + "'";
            }
            return std::nullopt;
          }};
}

Problem NormProblem(const Array& array, double tolerance) {
  const std::size_t stride = array.shape.back();
  return std::visit(
      [&](const auto& values) -> Problem {
        using Value = typename std::decay_t<decltype(values)>::value_type;
        if constexpr (std::is_floating_point_v<Value>) {
          for (std::size_t i = 0; i + 4 <= values.size(); i += stride) {
            double square = 0.0;
            for (std::size_t k = 0; k < 4; ++k) square += static_cast<double>(values[i + k]) * values[i + k];
            if (!(std::abs(std::sqrt(square) - 1.0) <= tolerance)) {
              return Place(array, i) + "starts a quaternion of norm " + FormatDouble(std::sqrt(square));
            }
          }
        }
        return std::nullopt;
      },
      array.values);
}

}  // namespace

Rule Anything() { return {"", nullptr}; }

Rule NotEmpty() {
  return Texts("not empty", [](const std::string& text) { return text.empty(); });
}

Rule EqualTo(const std::string& text) {
  return Texts("'" + text + "'", [text](const std::string& value) { return value != text; });
}

Rule OneOf(const std::vector<std::string>& texts) {
  std::string words = "one of";
  for (const std::string& text : texts) words += " " + text;
  return Texts(
      words, [texts](const std::string& value) { return std::find(texts.begin(), texts.end(), value) == texts.end(); });
}

Rule Finite() {
  return Numbers("finite", [](double value) { return !std::isfinite(value); });
}

Rule InRange(double low, double high) {
  return Numbers("in [" + FormatDouble(low) + ", " + FormatDouble(high) + "]",
                 [low, high](double value) { return !(value >= low && value <= high); });
}

Rule AtLeast(double low) {
  return Numbers("finite, at least " + FormatDouble(low),
                 [low](double value) { return !(value >= low) || !std::isfinite(value); });
}

Rule AtMost(double high) {
  return Numbers("finite, at most " + FormatDouble(high),
                 [high](double value) { return !(value <= high) || !std::isfinite(value); });
}

Rule NotZero() {
  return Numbers("finite, not 0", [](double value) { return value == 0.0 || !std::isfinite(value); });
}

Rule UnitQuaternion(double tolerance) {
  return {"unit quaternion (w, x, y, z) to " + FormatDouble(tolerance) + ", finite",
          [tolerance](const RuleContext& c) -> Problem {
            if (auto problem = NormProblem(c.array, tolerance)) return problem;
            return FirstNumber(c.array, [](double value) { return !std::isfinite(value); });
          }};
}

Rule Covariance() {
  return {"finite, diagonal not negative", [](const RuleContext& c) -> Problem {
            const auto& values = c.array.as<float>();
            for (std::size_t i = 0; i < values.size(); ++i) {
              const std::size_t k = i % 6;
              const bool diagonal = k == 0 || k == 3 || k == 5;
              if (!std::isfinite(values[i]) || (diagonal && values[i] < 0)) {
                return Place(c.array, i) + "is " + FormatDouble(static_cast<double>(values[i]));
              }
            }
            return std::nullopt;
          }};
}

Rule Sha256Digits(bool may_be_empty) {
  return Texts(may_be_empty ? "64 lower-case hexadecimal digits, or empty" : "64 lower-case hexadecimal digits",
               [may_be_empty](const std::string& text) {
                 if (text.empty()) return !may_be_empty;
                 return text.size() != 64 || text.find_first_not_of("0123456789abcdef") != std::string::npos;
               });
}

Rule RateText() {
  return Texts("a fraction from 1/1000 to 100000", [](const std::string& text) { return !FrameRate::Parse(text); });
}

Rule AxesText() {
  return Texts("three signed axes", [](const std::string& text) { return !AxisConvention::Parse(text); });
}

Rule JsonTexts() {
  return Texts("a JSON object whose values are texts", [](const std::string& text) {
    const auto json = ParseJson(text, "");
    return !json || !json->is_object() ||
           !std::all_of(json->begin(), json->end(), [](const nlohmann::json& value) { return value.is_string(); });
  });
}

Rule RowOf(const std::string& field, bool or_none) {
  return {"a row of " + field + (or_none ? ", or -1" : ""), [field, or_none](const RuleContext& c) -> Problem {
            const Array* target = c.content.Find(c.prefix + field);
            const double rows = target == nullptr ? 0.0 : static_cast<double>(target->rows());
            const double low = or_none ? -1.0 : 0.0;
            auto problem = FirstNumber(c.array, [&](double value) { return value < low || value >= rows; });
            if (problem) *problem += "; there are " + FormatDouble(rows) + " rows";
            return problem;
          }};
}

Rule UniqueNames() {
  return {"not empty, no two alike", [](const RuleContext& c) -> Problem {
            std::set<std::string> seen;
            const auto& texts = c.array.as<std::string>();
            for (std::size_t i = 0; i < texts.size(); ++i) {
              if (texts[i].empty()) return Place(c.array, i) + "is empty";
              if (!seen.insert(texts[i]).second) return Place(c.array, i) + "repeats '" + texts[i] + "'";
            }
            return std::nullopt;
          }};
}

Rule NotBelow(const std::string& sibling) {
  return {"finite, not below " + sibling, [sibling](const RuleContext& c) -> Problem {
            const Array* other = c.Sibling(sibling);
            if (other == nullptr || other->shape != c.array.shape || other->type() != c.array.type()) {
              return "does not fit " + sibling;
            }
            return std::visit(
                [&](const auto& values) -> Problem {
                  using Values = std::decay_t<decltype(values)>;
                  if constexpr (!std::is_same_v<Values, std::vector<std::string>>) {
                    const auto& lower = std::get<Values>(other->values);
                    for (std::size_t i = 0; i < values.size(); ++i) {
                      const double value = static_cast<double>(values[i]);
                      if (!std::isfinite(value) || !(values[i] >= lower[i])) {
                        return Place(c.array, i) + "is " + FormatDouble(value) + "; " + sibling + " is " +
                               FormatDouble(static_cast<double>(lower[i]));
                      }
                    }
                  }
                  return std::nullopt;
                },
                c.array.values);
          }};
}

Rule Rising() {
  return {"finite, strictly rising", [](const RuleContext& c) -> Problem {
            const auto& values = c.array.as<double>();
            for (std::size_t i = 0; i < values.size(); ++i) {
              const bool falls = i > 0 && !(values[i] > values[i - 1]);
              if (!std::isfinite(values[i]) || falls) {
                return Place(c.array, i) + "is " + FormatDouble(values[i]) +
                       (i > 0 ? " after " + FormatDouble(values[i - 1]) : "");
              }
            }
            return std::nullopt;
          }};
}

}  // namespace mocurate::store
