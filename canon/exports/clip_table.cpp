#include <algorithm>
#include <utility>

#include "canon/exports/clip_names.h"
#include "canon/exports/written_set.h"
#include "core/base/characters.h"
#include "core/base/table_text.h"
#include "core/base/text.h"

namespace mocurate {
namespace {

std::string CsvLine(const std::vector<std::string>& cells) {
  std::string line;
  for (const std::string& cell : cells) line += (line.empty() ? "" : ",") + CsvCell(cell);
  return line + "\n";
}

}  // namespace

WrittenClip WrittenClipOf(std::size_t position, const Clip& clip, std::string file) {
  WrittenClip written;
  written.position = position;
  written.file = std::move(file);
  written.person = clip.identity.person;
  written.recording = clip.identity.recording;
  written.label = clip.label;
  written.fine_label = clip.fine_label;
  written.licence = clip.identity.licence;
  written.role = clip.role;
  written.frames = clip.motion->frame_count();
  written.rate = clip.motion->rate;
  return written;
}

std::vector<std::string> PartOfEachClip(const Split& split, std::size_t clips) {
  std::vector<std::string> parts(clips);
  for (const int row : split.train) parts.at(static_cast<std::size_t>(row)) = "train";
  for (const int row : split.validation) parts.at(static_cast<std::size_t>(row)) = "validation";
  for (const int row : split.test) parts.at(static_cast<std::size_t>(row)) = "test";
  return parts;
}

ExportedFile ClipTable(const ExportSet& set, const std::vector<WrittenClip>& clips) {
  std::vector<std::string> header = {"file",  "clip",       "person", "recording", "label",
                                     "class", "fine_label", "frames", "rate_hz"};
  const bool states_origin = std::any_of(clips.begin(), clips.end(), [](const auto& c) { return !c.origin.empty(); });
  if (states_origin) header.insert(header.end(), {"origin", "raised_m"});
  std::vector<std::vector<std::string>> parts;
  for (const Split& split : set.splits) {
    header.push_back("split_" + WithoutControls(split.name));
    parts.push_back(PartOfEachClip(split, set.ids.size()));
  }
  std::string text = CsvLine(header);
  for (const WrittenClip& clip : clips) {
    const auto label = std::find(set.labels.begin(), set.labels.end(), clip.label);
    const ClipIdParts id = PartsOfClipId(set.ids[clip.position]);
    std::vector<std::string> cells = {clip.file,
                                      WithoutControls(set.ids[clip.position]),
                                      WithoutControls(id.person),
                                      WithoutControls(id.recording),
                                      WithoutControls(clip.label),
                                      label == set.labels.end() ? "" : std::to_string(label - set.labels.begin()),
                                      WithoutControls(clip.fine_label),
                                      std::to_string(clip.frames),
                                      FormatDouble(clip.rate.hz())};
    if (states_origin) cells.insert(cells.end(), {clip.origin, RoundedText(clip.raised_m, 6)});
    for (const std::vector<std::string>& of_split : parts) cells.push_back(of_split[clip.position]);
    text += CsvLine(cells);
  }
  return {kClipTable, std::move(text)};
}

Status OneRate::Check(const Clip& clip) {
  const FrameRate& rate = clip.motion->rate;
  if (!rate_) rate_ = rate;
  if (rate == *rate_) return {};
  return Fail(ErrorCode::kUnsupported,
              FormatDouble(rate.hz()) + " frames per second, the clips before have " + FormatDouble(rate_->hz()) +
                  ": files of this layout have no rate",
              clip.id(),
              "export clips of one rate: mocurate dataset subset --where 'rate == " + FormatDouble(rate_->hz()) +
                  "', or make the set with canon.rate");
}

}  // namespace mocurate
