#include "eval/tables/comparison.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>

#include "core/base/table_text.h"
#include "core/base/text.h"
#include "eval/tables/result_table.h"

namespace mocurate {
namespace {

/// Papers' names of real motions, our rows Real (ACTOR's "Real [A2M]" is quoted) and Real-test.
bool IsRealMethod(const std::string& method) {
  static const std::set<std::string> kNames = {"Real",      "Real motions", "Real-train",
                                               "Real-test", "Real*",        "Real [A2M]"};
  return kNames.count(method) > 0;
}

/// A network during its training (NAME/SEED@STEP) is no method of its own.
bool IsSample(const nlohmann::json& row) { return row.value("network", std::string()).find('@') != std::string::npos; }

/// The published method of a row; nothing where it has none.
std::optional<std::string> MethodOf(const nlohmann::json& row, const std::set<std::string>& methods,
                                    const ComparisonOptions& options) {
  const std::string name = row.at("name").get<std::string>();
  const std::string plain =
      name.substr(0, name.rfind('/'));  // NAME/SEED; names that contain '/' match as a whole first
  for (const std::string& known : {name, plain}) {
    const auto chosen = options.published_as.find(known);
    if (chosen != options.published_as.end()) {
      return chosen->second.empty() ? std::nullopt : std::optional<std::string>(chosen->second);
    }
    if (methods.count(known) > 0) return known;
  }
  if (name != "Real") return std::nullopt;
  for (const char* real : {"Real-train", "Real*", "Real motions", "Real"}) {
    if (methods.count(real) > 0) return real;
  }
  return std::nullopt;
}

/// The number of a method; from the first of several tables.
const nlohmann::json* ValueOf(const nlohmann::json& published, const std::string& method, const char* metric) {
  for (const nlohmann::json& value : published) {
    if (value.at("method") == method && value.at("metric") == metric) return &value;
  }
  return nullptr;
}

/// Ours divided by the published number, its interval likewise. ACTOR's +- is 1.96 times a variance and not an
/// interval: the sampled one replaces it.
Table::Cell RatioOf(const Table::Cell& ours, const nlohmann::json& metric, double published) {
  Table::Cell ratio;
  if (!ours.value || published == 0.0) return ratio;
  ratio.value = *ours.value / published;
  std::optional<std::array<double, 2>> interval = ours.interval;
  ratio.interval_kind = ours.interval_kind;
  if (ours.interval_kind == Name(IntervalKind::kActor)) {
    const nlohmann::json sampled = metric.value("sampled", nlohmann::json());
    interval.reset();
    if (sampled.is_object()) {
      interval = sampled.at("interval").get<std::array<double, 2>>();
      ratio.interval_kind = sampled.at("kind").get<std::string>();
    }
  }
  if (interval) ratio.interval = {(*interval)[0] / published, (*interval)[1] / published};
  return ratio;
}

nlohmann::json JsonOf(const std::optional<std::array<double, 2>>& interval) {
  return interval ? nlohmann::json(*interval) : nlohmann::json();
}

/// Two rows of generated motions, by one metric.
struct Pair {
  double ours, published;
};

/// Share of all orders of rows with at least `as_published` pairs in the published order. `ties`: sizes of the groups
/// of equal published numbers. By the q-multinomial coefficient, whose k-th term counts orders with k such pairs.
/// [Kendall 1938; ties as MacMahon 1913]
double ChanceOfOrder(int as_published, const std::map<double, int>& ties) {
  int rows = 0;
  for (const auto& [published, size] : ties) rows += size;
  const auto terms = static_cast<std::size_t>(rows * (rows - 1) / 2 + 1);
  std::vector<double> orders(terms, 0.0);
  orders[0] = 1.0;
  const auto multiply = [&](std::size_t power) {  // by 1 - q^power
    for (std::size_t k = terms; k-- > power;) orders[k] -= orders[k - power];
  };
  const auto divide = [&](std::size_t power) {
    for (std::size_t k = power; k < terms; ++k) orders[k] += orders[k - power];
  };
  for (std::size_t i = 1; i <= static_cast<std::size_t>(rows); ++i) {
    multiply(i);
    divide(1);
  }
  for (const auto& [published, size] : ties) {
    for (std::size_t i = 1; i <= static_cast<std::size_t>(size); ++i) {
      multiply(1);
      divide(i);
    }
  }
  double all = 0.0, as_many = 0.0;
  for (std::size_t k = 0; k < terms; ++k) {
    all += orders[k];
    if (k >= static_cast<std::size_t>(as_published)) as_many += orders[k];
  }
  return as_many / all;
}

/// How many pairs of rows are in the published order; pairs of equal published numbers do not count.
nlohmann::json OrderOf(const std::vector<Pair>& numbers) {
  int pairs = 0, same = 0, equal = 0;
  std::map<double, int> ties;
  for (const Pair& one : numbers) ++ties[one.published];
  for (std::size_t a = 0; a < numbers.size(); ++a) {
    for (std::size_t b = a + 1; b < numbers.size(); ++b) {
      const double published = numbers[a].published - numbers[b].published;
      if (published == 0.0) continue;
      ++pairs;
      const double ours = numbers[a].ours - numbers[b].ours;
      if (published * ours > 0.0) ++same;
      if (ours == 0.0) ++equal;
    }
  }
  return {{"pairs", pairs}, {"as_published", same}, {"equal", equal}, {"p", ChanceOfOrder(same, ties)}};
}

/// Columns of the comparison: metrics that something was published of, and ours that show whether a network copies or
/// compares with real motions; where nothing was published, all that a row of ours has.
std::vector<const MetricColumn*> ComparedColumns(const nlohmann::json& result, const nlohmann::json& published) {
  static const std::set<std::string> kAlways = {"nearest_train", "FID_test", "FID_equal", "FID_train_published",
                                                "accuracy_published"};
  std::vector<const MetricColumn*> columns;
  for (const MetricColumn& column : MetricColumns()) {
    const bool known = std::any_of(published.begin(), published.end(),
                                   [&](const nlohmann::json& value) { return value.at("metric") == column.key; });
    const bool ours = std::any_of(result.at("rows").begin(), result.at("rows").end(), [&](const nlohmann::json& row) {
      return CellOf(row.value("metrics", nlohmann::json::object()).value(column.key, nlohmann::json()))
          .value.has_value();
    });
    if (published.empty() || kAlways.count(column.key) > 0 ? ours && column.shown : known) columns.push_back(&column);
  }
  return columns;
}

}  // namespace

Comparison ComparePublished(const nlohmann::json& result, const ComparisonOptions& options) {
  const nlohmann::json published = result.value("published", nlohmann::json::array());
  std::set<std::string> methods;
  std::vector<std::string> in_order;
  for (const nlohmann::json& value : published) {
    if (methods.insert(value.at("method").get<std::string>()).second) in_order.push_back(value.at("method"));
  }
  const std::vector<const MetricColumn*> columns = ComparedColumns(result, published);
  const auto is_published = [&](const MetricColumn* column) {
    return std::any_of(published.begin(), published.end(),
                       [&](const nlohmann::json& value) { return value.at("metric") == column->key; });
  };
  Comparison comparison;
  comparison.rows = nlohmann::json::array();
  Table& table = comparison.table;
  table.title = options.title;
  for (const MetricColumn* column : columns) {
    table.columns.emplace_back(column->title);
    table.digits.push_back(column->digits);
    if (!is_published(column)) continue;
    table.columns.emplace_back(std::string(column->title) + ", published");
    table.digits.push_back(column->digits);
    table.columns.emplace_back(std::string(column->title) + ", ours / published");
    table.digits.push_back(2);
  }
  const bool same_features = result.value("published_features", false);
  bool without_ratio = false;
  std::map<std::string, std::vector<Pair>> pairs;
  std::set<std::string> shown;
  const auto add = [&](const std::string& name, const std::string& profile, const nlohmann::json& metrics,
                       const std::optional<std::string>& method, bool unordered, bool unconverged, bool given) {
    Table::Row row{name + (profile.empty() ? "" : " [" + profile + "]"), {}, "", unconverged, given};
    nlohmann::json compared = nlohmann::json::object();
    for (const MetricColumn* column : columns) {
      const nlohmann::json metric = metrics.value(column->key, nlohmann::json());
      const Table::Cell ours = CellOf(metric);
      row.cells.push_back(ours);
      nlohmann::json& json = compared[column->key];
      json = {{"value", ours.value ? nlohmann::json(*ours.value) : nlohmann::json()},
              {"interval", JsonOf(ours.interval)},
              {"interval_kind", ours.interval ? nlohmann::json(ours.interval_kind) : nlohmann::json()},
              {"published", nullptr},
              {"published_pm", nullptr},
              {"pm_kind", nullptr},
              {"ratio", nullptr},
              {"ratio_interval", nullptr},
              {"why_no_ratio", nullptr}};
      if (!is_published(column)) continue;
      const nlohmann::json* value = method ? ValueOf(published, *method, column->key) : nullptr;
      if (value == nullptr) {
        row.cells.resize(row.cells.size() + 2);
        continue;
      }
      const Table::Cell theirs = PublishedCell(*value);
      const bool other = column->of_features && !same_features;
      const Table::Cell ratio = other ? Table::Cell() : RatioOf(ours, metric, *theirs.value);
      if (other && ours.value) {
        json["why_no_ratio"] = "other_features";
        without_ratio = true;
      }
      row.cells.push_back(theirs);
      row.cells.push_back(ratio);
      json["published"] = *theirs.value;
      json["published_pm"] = value->at("pm");
      json["pm_kind"] = value->at("pm_kind");
      if (ratio.value) json["ratio"] = *ratio.value;
      json["ratio_interval"] = JsonOf(ratio.interval);
      const bool ordered = column->better == Better::kLess || column->better == Better::kMore;
      if (ours.value && ordered && !unordered) pairs[column->key].push_back({*ours.value, *theirs.value});
    }
    comparison.rows.push_back({{"method", name},
                               {"published_as", method ? nlohmann::json(*method) : nlohmann::json()},
                               {"profile", profile.empty() ? nlohmann::json() : nlohmann::json(profile)},
                               {"metrics", std::move(compared)}});
    table.rows.push_back(std::move(row));
  };
  for (const nlohmann::json& row : result.at("rows")) {
    const std::optional<std::string> method = MethodOf(row, methods, options);
    if (method) shown.insert(*method);
    const std::string name = row.at("name").get<std::string>();
    if (method && options.published_as.count(name) > 0) {
      table.notes.push_back(name + " is compared with the published " + *method + ".");
    }
    add(name, row.value("profile", options.profile), row.value("metrics", nlohmann::json::object()), method,
        row.contains("profile") || row.contains("given") || IsSample(row) || row.value("real", IsRealMethod(name)),
        row.contains("unconverged"), row.value("given", "") == kGivenFirstPose);
  }
  for (const std::string& method : in_order) {
    if (shown.count(method) == 0) add(method, "", nlohmann::json::object(), method, IsRealMethod(method), false, false);
  }
  if (without_ratio) {
    table.notes.emplace_back(
        "No ratio to the published numbers: ours are of another recogniser or other data, and features of two "
        "recognisers have no common scale.");
  }
  for (const MetricColumn* column : columns) {
    const auto numbers = pairs.find(column->key);
    if (numbers == pairs.end()) continue;
    nlohmann::json order = OrderOf(numbers->second);
    if (order.at("pairs") == 0) continue;
    order["metric"] = column->key;
    table.notes.push_back(std::string(column->title) + ": " + order.at("as_published").dump() + " of " +
                          order.at("pairs").dump() + " pairs of rows are in the published order" +
                          (order.at("equal") == 0 ? "" : ", ours are equal in " + order.at("equal").dump()) +
                          "; an order by chance has as many with p " + RoundedText(order.at("p").get<double>(), 3) +
                          ".");
    comparison.order.push_back(std::move(order));
  }
  for (const nlohmann::json& value : published) {
    const std::string source = "Published: " + value.at("source").get<std::string>() + ".";
    if (std::find(table.notes.begin(), table.notes.end(), source) == table.notes.end()) table.notes.push_back(source);
  }
  return comparison;
}

std::string ComparisonCsvHead() {
  return "set,method,published_as,profile,metric,value,interval_low,interval_high,interval_kind,published,published_pm,"
         "pm_kind,ratio,ratio_low,ratio_high\n";
}

std::string ComparisonCsv(const std::string& set, const Comparison& comparison) {
  const auto text = [](const nlohmann::json& value) {
    return value.is_string() ? QuotedCsvCell(value.get<std::string>()) : std::string();
  };
  const auto number = [](const nlohmann::json& value) {
    return value.is_number() ? FormatDouble(value.get<double>()) : std::string();
  };
  const auto pair = [&](const nlohmann::json& interval) {
    return interval.is_array() ? number(interval[0]) + "," + number(interval[1]) : std::string(",");
  };
  std::string csv;
  for (const nlohmann::json& row : comparison.rows) {
    const nlohmann::json& metrics = row.at("metrics");
    for (const auto& [metric, one] : metrics.items()) {
      if (!one.at("value").is_number() && !one.at("published").is_number()) continue;
      csv += QuotedCsvCell(set) + "," + text(row.at("method")) + "," + text(row.at("published_as")) + "," +
             text(row.at("profile")) + "," + metric + "," + number(one.at("value")) + "," + pair(one.at("interval")) +
             "," + text(one.at("interval_kind")) + "," + number(one.at("published")) + "," +
             number(one.at("published_pm")) + "," + text(one.at("pm_kind")) + "," + number(one.at("ratio")) + "," +
             pair(one.at("ratio_interval")) + "\n";
    }
  }
  return csv;
}

}  // namespace mocurate
