#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "core/store/store.h"
#include "report/filmstrip.h"
#include "report/options.h"

namespace mocurate {

/// Input of the report page.
struct ReportInput {
  nlohmann::json run;  ///< the summary of the run; parts that it did not reach are absent
  std::optional<Dataset> dataset;
  std::vector<DrawnClip> drawn;
  std::vector<std::string> not_drawn;  ///< why a clip or a view could not be drawn
  ReportOptions options;
};

/// Each returns the inside of one <section>; parts that the run did not reach are reported there.
std::string HeadHtml(const ReportInput& input);        ///< name, verdict, figures
std::string FunnelHtml(const ReportInput& input);      ///< clips by stage, reasons of excluded ones
std::string DatasetHtml(const ReportInput& input);     ///< labels, splits
std::string QualityHtml(const ReportInput& input);     ///< before and after
std::string TruthHtml(const ReportInput& input);       ///< error against truth
std::string FilmstripsHtml(const ReportInput& input);  ///< strips
std::string ClipsHtml(const ReportInput& input);       ///< all clips, with links to their pages
std::string PersonsHtml(const ReportInput& input);     ///< bone lengths
std::string FindingsHtml(const ReportInput& input);
std::string TableHtml(const ReportInput& input);        ///< metrics of the evaluation
std::string GeneratedHtml(const ReportInput& input);    ///< motions of each class and network beside real ones
std::string RecognisersHtml(const ReportInput& input);  ///< accuracies and confusion
std::string CurvesHtml(const ReportInput& input);       ///< loss curves
std::string StopsHtml(const ReportInput& input);        ///< where training was stopped
std::string ReadingHtml(const ReportInput& input);      ///< how to read the page

/// Link to a clip in the viewer beside the page, by its id at one of its frames, or by its recording at one of that;
/// the escaped text alone where there is no viewer or no such clip.
std::string ViewerLink(const ReportInput& input, const std::string& name, int frame, const std::string& text);

/// The whole page, self-contained. Same input, same bytes.
std::string MakePage(const ReportInput& input);

}  // namespace mocurate
