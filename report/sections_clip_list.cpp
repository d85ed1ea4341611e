#include <algorithm>

#include "report/html.h"
#include "report/page.h"
#include "report/run_facts.h"

namespace mocurate {
namespace {

constexpr std::size_t kMostRows = 400;

std::string NumberCell(const nlohmann::json& json, const char* key, int digits) {
  const auto value = NumberOf(json, key);
  return value ? FixedText(*value, digits) : "–";
}

std::string Change(const nlohmann::json& fitting, const char* key, int digits) {
  return NumberCell(Field(fitting, "before"), key, digits) + " → " + NumberCell(Field(fitting, "after"), key, digits);
}

/// Share of observations that the fit rejected as outliers; the residual excludes them.
std::string RejectedCell(const nlohmann::json& fitting) {
  const auto share = NumberOf(fitting, "rejected_share");
  return share ? PercentText(*share) : "–";
}

}  // namespace

std::string ClipsHtml(const ReportInput& input) {
  const nlohmann::json& pages = Field(input.run, "pages");
  std::vector<const nlohmann::json*> clips;
  for (const nlohmann::json& clip : Elements(Field(input.run, "clips"))) {
    if (NumberOf(Field(clip, "fitting"), "residual_rms_mm")) clips.push_back(&clip);
  }
  if (clips.empty()) return Paragraph("No clip was fitted.");
  const auto has_page = [&pages](const nlohmann::json* clip) {
    return Field(pages, TextOf(*clip, "item").c_str()).is_object();
  };
  const auto residual = [](const nlohmann::json* clip) {
    return *NumberOf(Field(*clip, "fitting"), "residual_rms_mm");
  };
  std::stable_sort(clips.begin(), clips.end(), [&](const nlohmann::json* a, const nlohmann::json* b) {
    if (has_page(a) != has_page(b)) return has_page(a);
    return residual(a) < residual(b);
  });
  HtmlTable table{
      "Best fits first, those with a page of their own on top",
      {"Clip", "Residual RMS, mm", "Rejected", "Bone length std, mm", "Jerk, m/s³", "Frames corrected", "Findings"},
      {},
      true};
  for (const nlohmann::json* clip : clips) {
    if (table.rows.size() >= kMostRows) break;
    const std::string item = TextOf(*clip, "item");
    const nlohmann::json& fitting = Field(*clip, "fitting");
    std::string name = EscapeHtml(item);
    if (has_page(clip)) {
      const nlohmann::json& files = Field(pages, item.c_str());
      name = "<a href=\"" + EscapeHtml(TextOf(files, "page")) + "\">" + name + "</a>";
      const std::string video = TextOf(files, "video");
      if (!video.empty()) name += ", <a href=\"" + EscapeHtml(video) + "\">video</a>";
    }
    table.rows.push_back({name, NumberCell(fitting, "residual_rms_mm", 1), RejectedCell(fitting),
                          Change(fitting, "bone_spread_mm", 1), Change(fitting, "jerk", 0),
                          CountText(CountOf(Field(fitting, "repairs"), "any_frames")),
                          CountText(static_cast<long long>(Elements(Field(*clip, "findings")).size()))});
  }
  const std::size_t left = clips.size() - table.rows.size();
  return table.Html() +
         (left > 0 ? Paragraph(CountText(static_cast<long long>(left)) + " more clips are in the dataset.", "soft")
                   : "");
}

}  // namespace mocurate
