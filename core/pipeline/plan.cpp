#include "core/pipeline/plan.h"

#include <algorithm>
#include <fstream>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <numeric>

#include "core/base/file.h"
#include "core/base/text.h"

namespace mocurate {

NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(PlanHead, program, stage, stage_version, config, config_sha256, arguments,
                                   blas_kernels, instructions, cache, items, tasks)

namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr int kPlanVersion = 2;
constexpr std::size_t kLongestHead = 1 << 20;
constexpr std::string_view kTasksBegin = ", \"tasks\": [";  ///< behind the head, at the end of the first line

/// The options and items of a task; options that items share are stored once.
json TaskJson(const ItemSpec* begin, const ItemSpec* end) {
  std::map<std::string, std::size_t> known;
  json options = json::array(), items = json::array();
  for (const ItemSpec* spec = begin; spec != end; ++spec) {
    json whole = spec->options.Whole();
    const auto [place, is_new] = known.emplace(CanonicalText(whole), options.size());
    if (is_new) options.push_back(std::move(whole));
    json inputs = json::array();
    for (const StageInput& input : spec->inputs)
      inputs.push_back({input.role, input.name, input.path.native(), input.sha256});
    items.push_back({{"item", spec->item}, {"options", place->second}, {"inputs", std::move(inputs)}});
  }
  return {{"options", std::move(options)}, {"items", std::move(items)}};
}

std::vector<ItemSpec> ItemsFromJson(const json& task) {
  std::vector<ItemOptions> options;
  for (const json& one : task.at("options")) options.emplace_back(one);
  std::vector<ItemSpec> items;
  for (const json& item : task.at("items")) {
    ItemSpec spec{item.at("item").get<std::string>(), options.at(item.at("options").get<std::size_t>()), {}};
    for (const json& input : item.at("inputs")) {
      spec.inputs.push_back({input.at(0).get<std::string>(), input.at(1).get<std::string>(),
                             input.at(2).get<std::string>(), input.at(3).get<std::string>()});
    }
    items.push_back(std::move(spec));
  }
  return items;
}

tl::unexpected<Error> NotAPlan(const fs::path& file, const std::string& what, const char* place) {
  return Fail(ErrorCode::kMalformed, what, DisplayPath(file) + ": " + place, "make it again: mocurate plan");
}

/// The next line up to `longest` bytes, without its end; false where it is cut short or longer.
bool NextLine(std::istream& stream, std::string& line, std::size_t longest = std::string::npos) {
  line.clear();
  for (char c = 0; stream.get(c) && c != '\n';) {
    line += c;
    if (line.size() > longest) return false;
  }
  return static_cast<bool>(stream);
}

}  // namespace

Status Plan::Write(const fs::path& file, PlanHead head, const std::vector<ItemSpec>& items,
                   const std::vector<std::size_t>& ends) {
  head.items = items.size();
  head.tasks = ends.size();
  return WriteFileWith(file, [&](const fs::path& temporary) -> Status {
    std::ofstream out(temporary, std::ios::binary);
    out << "{\"mocurate_plan\": " << kPlanVersion << ", \"head\": " << CanonicalText(head) << kTasksBegin << '\n';
    for (std::size_t k = 0; k < ends.size(); ++k) {
      const ItemSpec* begin = items.data() + (k == 0 ? 0 : ends[k - 1]);
      out << CanonicalText(TaskJson(begin, items.data() + ends[k])) << (k + 1 < ends.size() ? ",\n" : "\n");
    }
    out << "]}\n";
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
  std::ifstream stream(file, std::ios::binary);
  if (!stream) return Fail(ErrorCode::kUnreadable, "the plan cannot be read", DisplayPath(file));
  std::string line;
  if (!NextLine(stream, line, kLongestHead) || line.size() < kTasksBegin.size() ||
      line.compare(line.size() - kTasksBegin.size(), kTasksBegin.size(), kTasksBegin) != 0) {
    return NotAPlan(file, "this is not a plan", "line 1");
  }
  line.replace(line.size() - kTasksBegin.size(), kTasksBegin.size(), "}");
  const Expected<json> value = FromCanonicalText(line, DisplayPath(file));
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
    plan.head_ = value->at("head").get<PlanHead>();
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
  std::ifstream stream(file_, std::ios::binary);
  for (std::size_t line = 0; line <= task && stream; ++line)
    stream.ignore(std::numeric_limits<std::streamsize>::max(), '\n');
  std::string line;
  if (!NextLine(stream, line)) return NotAPlan(file_, "the file is cut short", "tasks");
  if (!line.empty() && line.back() == ',') line.pop_back();
  const Expected<json> value = FromCanonicalText(line, DisplayPath(file_) + ": task " + std::to_string(task));
  if (!value) return Forward(value);
  try {
    return ItemsFromJson(*value);
  } catch (const json::exception& wrong) {
    return NotAPlan(file_, wrong.what(), "tasks");
  } catch (const std::out_of_range&) {
    return NotAPlan(file_, "options by a number that it does not have", "tasks");
  }
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
