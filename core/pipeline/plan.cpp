#include "core/pipeline/plan.h"

#include <algorithm>
#include <charconv>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <numeric>

#include "core/base/file.h"
#include "core/base/text.h"
#include "core/pipeline/wire.h"

namespace mocurate {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr int kPlanVersion = 1;
constexpr std::size_t kOffsetDigits = 16;          ///< of a number in an index; offsets below 10^16
constexpr std::size_t kEntry = kOffsetDigits + 2;  ///< with its comma and line end
constexpr std::size_t kLongestHead = 1 << 20;

/// A number of fixed width, as an entry of an index or in the head.
std::string Fixed(std::uint64_t number) {
  const std::string digits = std::to_string(number);
  return std::string(kOffsetDigits - std::min(kOffsetDigits, digits.size()), ' ') + digits;
}

std::string Index(const std::vector<std::uint64_t>& numbers) {
  std::string text;
  for (std::size_t i = 0; i < numbers.size(); ++i) text += Fixed(numbers[i]) + (i + 1 < numbers.size() ? ",\n" : " \n");
  return text;
}

json HeadJson(const PlanHead& head) {
  return {{"program", head.program},
          {"stage", head.stage},
          {"stage_version", head.stage_version},
          {"config", head.config},
          {"config_sha256", head.config_sha256},
          {"arguments", head.arguments},
          {"blas_kernels", head.blas_kernels},
          {"instructions", head.instructions},
          {"cache", head.cache.native()},
          {"items", head.items},
          {"tasks", head.tasks}};
}

PlanHead HeadFromJson(const json& value) {
  PlanHead head;
  head.program = value.at("program").get<std::string>();
  head.stage = value.at("stage").get<std::string>();
  head.stage_version = value.at("stage_version").get<int>();
  head.config = value.at("config").get<std::string>();
  head.config_sha256 = value.at("config_sha256").get<std::string>();
  head.arguments = value.at("arguments").get<std::vector<std::string>>();
  head.blas_kernels = value.at("blas_kernels").get<std::string>();
  head.instructions = value.at("instructions").get<std::string>();
  head.cache = value.at("cache").get<std::string>();
  head.items = value.at("items").get<std::size_t>();
  head.tasks = value.at("tasks").get<std::size_t>();
  return head;
}

json ItemJson(const ItemSpec& spec, std::size_t options) {
  json inputs = json::array();
  for (const StageInput& input : spec.inputs)
    inputs.push_back({input.role, input.name, input.path.native(), input.sha256});
  return {{"item", spec.item}, {"options", options}, {"inputs", inputs}};
}

tl::unexpected<Error> NotAPlan(const fs::path& file, const std::string& what, const char* place) {
  return Fail(ErrorCode::kMalformed, what, DisplayPath(file) + ": " + place, "make it again: mocurate plan");
}

/// Reads parts of a plan.
class PlanReader {
 public:
  explicit PlanReader(const fs::path& file) : file_(file), stream_(file, std::ios::binary) {
    std::error_code problem;
    size_ = fs::file_size(file, problem);
  }

  bool open() const { return stream_.is_open(); }

  Expected<std::string> Line(std::uint64_t offset, std::size_t longest = std::string::npos) {
    stream_.clear();
    stream_.seekg(static_cast<std::streamoff>(offset));
    std::string line;
    for (char c = 0; stream_.get(c) && c != '\n';) {
      line += c;
      if (line.size() > longest) break;
    }
    if (!stream_ || line.size() > longest) return NotAPlan(file_, "the file is cut short", "a line");
    return line;
  }

  /// The value of a line.
  Expected<json> Value(std::uint64_t offset) {
    Expected<std::string> line = Line(offset);
    if (!line) return Forward(line);
    read_ += line->size();
    if (read_ > size_) return NotAPlan(file_, "lines overlap", "item_offsets and option_offsets");
    while (!line->empty() && (line->back() == ',' || line->back() == ' ')) line->pop_back();
    return FromCanonicalText(*line, DisplayPath(file_) + ": byte " + std::to_string(offset));
  }

  /// Entry `at` of an index.
  Expected<std::uint64_t> Entry(std::uint64_t index, std::uint64_t at) {
    const Expected<std::string> line = Line(index + at * kEntry, kEntry);
    if (!line) return Forward(line);
    const std::string_view digits = Trim(std::string_view(*line).substr(0, kOffsetDigits));
    std::uint64_t number = 0;
    const auto read = std::from_chars(digits.data(), digits.data() + digits.size(), number);
    if (read.ec != std::errc() || read.ptr != digits.data() + digits.size())
      return NotAPlan(file_, "'" + *line + "' is not an offset", "an index");
    return number;
  }

 private:
  fs::path file_;
  std::ifstream stream_;
  std::uint64_t size_ = 0;
  std::uint64_t read_ = 0;  ///< bytes of all values: each is read once
};

}  // namespace

Status Plan::Write(const fs::path& file, PlanHead head, const std::vector<ItemSpec>& items,
                   const std::vector<std::size_t>& ends) {
  head.items = items.size();
  head.tasks = ends.size();
  return WriteFileWith(file, [&](const fs::path& temporary) -> Status {
    std::ofstream out(temporary, std::ios::binary);
    std::map<std::string, std::size_t> known;  // options that items share are stored once
    std::vector<std::string> options;
    std::vector<std::uint64_t> item_at, option_at, task_at;
    std::uint64_t offset = 0;
    const auto add = [&](const std::string& text) {
      out << text;
      offset += text.size();
    };
    // The offsets of the indices are known in the end.
    const auto first_line = [&](std::uint64_t item_index, std::uint64_t option_index, std::uint64_t task_index) {
      return "{\"mocurate_plan\": " + std::to_string(kPlanVersion) + ", \"item_index\": " + Fixed(item_index) +
             ", \"option_index\": " + Fixed(option_index) + ", \"task_index\": " + Fixed(task_index) +
             ", \"head\": " + CanonicalText(HeadJson(head)) + ",\n";
    };
    add(first_line(0, 0, 0));
    add("\"items\": [\n");
    for (std::size_t i = 0; i < items.size(); ++i) {
      const auto [place, is_new] = known.emplace(CanonicalText(items[i].options.Whole()), options.size());
      if (is_new) options.push_back(place->first);
      item_at.push_back(offset);
      add(CanonicalText(ItemJson(items[i], place->second)) + (i + 1 < items.size() ? ",\n" : "\n"));
    }
    add("],\n\"options\": [\n");
    for (std::size_t i = 0; i < options.size(); ++i) {
      option_at.push_back(offset);
      add(options[i] + (i + 1 < options.size() ? ",\n" : "\n"));
    }
    for (const std::size_t end : ends) task_at.push_back(end);
    add("],\n\"item_offsets\": [\n");
    const std::uint64_t item_index = offset;
    add(Index(item_at) + "],\n\"option_offsets\": [\n");
    const std::uint64_t option_index = offset;
    add(Index(option_at) + "],\n\"task_ends\": [\n");
    const std::uint64_t task_index = offset;
    add(Index(task_at) + "]}\n");
    out.seekp(0);
    out << first_line(item_index, option_index, task_index);
    out.close();
    if (!out) return Fail(ErrorCode::kCannotWrite, "the plan cannot be written", DisplayPath(file), "free some space");
    return {};
  });
}

Expected<Plan> Plan::Open(const fs::path& file) {
  std::error_code problem;
  if (!fs::exists(file, problem))
    return Fail(ErrorCode::kNotFound, "no such plan", DisplayPath(file), "make it: mocurate plan CONFIG --stage S");
  if (!fs::is_regular_file(file, problem)) return NotAPlan(file, "this is a folder or a pipe, not a plan", "line 1");
  PlanReader reader(file);
  if (!reader.open()) return Fail(ErrorCode::kUnreadable, "the plan cannot be read", DisplayPath(file));
  Expected<std::string> line = reader.Line(0, kLongestHead);
  if (!line || line->empty() || line->back() != ',') return NotAPlan(file, "this is not a plan", "line 1");
  line->back() = '}';
  const Expected<json> value = FromCanonicalText(*line, DisplayPath(file));
  if (!value) return Forward(value);
  if (!value->is_object() || !value->contains("mocurate_plan")) return NotAPlan(file, "this is not a plan", "line 1");
  Plan plan;
  plan.file_ = file;
  try {
    if (const int version = value->at("mocurate_plan").get<int>(); version != kPlanVersion) {
      return Fail(
          ErrorCode::kUnsupported,
          "version " + std::to_string(version) + " of plans; this program reads " + std::to_string(kPlanVersion),
          DisplayPath(file), "plan again with this mocurate: mocurate plan");
    }
    plan.item_index_ = value->at("item_index").get<std::uint64_t>();
    plan.option_index_ = value->at("option_index").get<std::uint64_t>();
    plan.task_index_ = value->at("task_index").get<std::uint64_t>();
    plan.head_ = HeadFromJson(value->at("head"));
  } catch (const json::exception& wrong) {
    return NotAPlan(file, wrong.what(), "line 1");
  }
  return plan;
}

Expected<std::vector<ItemSpec>> Plan::Task(std::size_t task) const {
  if (task >= head_.tasks) {
    return Fail(ErrorCode::kUsage,
                "task " + std::to_string(task) + " of a plan with " +
                    Counted(static_cast<long long>(head_.tasks), "task") +
                    (head_.tasks == 0 ? "" : ", 0 to " + std::to_string(head_.tasks - 1)),
                DisplayPath(file_), head_.tasks == 0 ? "nothing of this stage is missing: plan the next one" : "");
  }
  PlanReader reader(file_);
  const Expected<std::uint64_t> begin =
      task == 0 ? Expected<std::uint64_t>(0) : reader.Entry(task_index_, static_cast<std::uint64_t>(task) - 1);
  if (!begin) return Forward(begin);
  const Expected<std::uint64_t> end = reader.Entry(task_index_, task);
  if (!end) return Forward(end);
  if (*end > head_.items || *begin > *end) return NotAPlan(file_, "tasks end beyond the items", "task_ends");
  std::map<std::size_t, ItemOptions> options;
  std::vector<ItemSpec> items;
  for (std::uint64_t i = *begin; i < *end; ++i) {
    const Expected<std::uint64_t> at = reader.Entry(item_index_, i);
    if (!at) return Forward(at);
    const Expected<json> value = reader.Value(*at);
    if (!value) return Forward(value);
    try {
      const auto of = value->at("options").get<std::size_t>();
      if (options.count(of) == 0) {
        const Expected<std::uint64_t> place = reader.Entry(option_index_, of);
        if (!place) return Forward(place);
        Expected<json> read = reader.Value(*place);
        if (!read) return Forward(read);
        options.emplace(of, *std::move(read));
      }
      ItemSpec spec{value->at("item").get<std::string>(), options.at(of), {}};
      for (const json& input : value->at("inputs")) {
        spec.inputs.push_back({input.at(0).get<std::string>(), input.at(1).get<std::string>(),
                               input.at(2).get<std::string>(), input.at(3).get<std::string>()});
      }
      items.push_back(std::move(spec));
    } catch (const json::exception& wrong) {
      return NotAPlan(file_, wrong.what(), "items");
    }
  }
  return items;
}

std::vector<std::size_t> CutByCost(const std::vector<double>& costs, std::size_t tasks) {
  tasks = std::min(tasks, costs.size());
  std::vector<std::size_t> ends;
  double left = std::accumulate(costs.begin(), costs.end(), 0.0);
  std::size_t at = 0;
  for (std::size_t k = 0; k < tasks; ++k) {
    const std::size_t after = tasks - k - 1;  // tasks that need an item each
    const double share = left / static_cast<double>(after + 1);
    double taken = 0.0;
    do {
      taken += costs[at++];
    } while (at + after < costs.size() && (after == 0 || taken + 0.5 * costs[at] < share));
    left -= taken;
    ends.push_back(at);
  }
  return ends;
}

}  // namespace mocurate
