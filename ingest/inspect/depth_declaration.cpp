// Folders of depth images: what their names say, and the declaration of those that stand beside calibrations alone.

#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include "core/base/file.h"
#include "core/formats/depth_sequence.h"
#include "core/formats/png.h"
#include "ingest/folder_listing.h"
#include "ingest/grouped_files.h"
#include "ingest/inspect/declaration_writer.h"
#include "ingest/inspect/file_kind.h"
#include "ingest/inspect/file_names.h"
#include "ingest/sources/pattern.h"

namespace mocurate {
namespace {

constexpr std::size_t kMostImages = 5000;

bool IsDepthPng(const std::filesystem::path& path) {
  const Expected<std::string> head = ReadHead(path);
  const Expected<PngHeader> header = ReadPngHeader(head.value_or(""), "");
  return header && header->bits == 16 && header->channels == 1;
}

/// Whether two characters that follow each other belong to one word or one number.
bool OnePart(char a, char b) { return IsDigit(a) ? IsDigit(b) : IsLetter(a) && IsLetter(b); }

/// Where `part` next stands in `text` as whole words and numbers: "p" in "p_01" and "p01", not in "depth".
std::size_t FindPart(const std::string& text, const std::string& part, std::size_t from) {
  for (std::size_t at = text.find(part, from); at != std::string::npos; at = text.find(part, at + 1)) {
    const std::size_t end = at + part.size();
    const bool begins = at == 0 || !OnePart(text[at - 1], part.front());
    if (begins && (end == text.size() || !OnePart(part.back(), text[end]))) return at;
  }
  return std::string::npos;
}

/// `from` in `text` becomes `to` where it stands as whole words and numbers: "p" in "p_01" and "p01", not in "depth".
void ReplaceParts(std::string& text, const std::string& from, const std::string& to) {
  for (std::size_t at = FindPart(text, from, 0); at != std::string::npos; at = FindPart(text, from, at + to.size())) {
    text.replace(at, from.size(), to);
  }
}

/// Names of images below a folder, of depth (16 bits) or not, sorted, the first few thousand. `part`: of those alone in
/// whose name it stands as whole words and numbers; empty: of all.
std::vector<std::string> ImagesBelow(const std::filesystem::path& folder, bool depth, const std::string& part = "") {
  std::vector<std::string> all;
  for (const std::filesystem::path& file : FilesBelow(folder)) {
    const std::string ending = file.extension().string(), name = file.lexically_relative(folder).native();
    const bool image = ending == ".png" || (!depth && (ending == ".jpg" || ending == ".jpeg"));
    if (image && (part.empty() || FindPart(name, part, 0) != std::string::npos)) all.push_back(name);
  }
  std::sort(all.begin(), all.end());
  std::vector<std::string> names;
  for (const std::string& name : all) {
    if (IsDepthPng(folder / name) != depth) continue;
    names.push_back(DisplayPath(name));
    if (names.size() == kMostImages) break;
  }
  return names;
}

/// One name as a pattern; empty where no camera is in it.
std::string CameraPattern(const std::string& name, const std::vector<std::string>& cameras, const std::string& field) {
  std::string longest;
  for (const std::string& camera : cameras) {
    if (camera.size() > longest.size() && FindPart(name, camera, 0) != std::string::npos) longest = camera;
  }
  if (longest.empty()) return "";
  std::string pattern = name;
  ReplaceParts(pattern, longest, "{" + field + "}");
  const std::size_t dot = pattern.rfind('.');
  std::size_t end = std::min(dot, pattern.size());
  const std::size_t begin_of_base = pattern.rfind('/') == std::string::npos ? 0 : pattern.rfind('/') + 1;
  while (end > begin_of_base && !IsDigit(pattern[end - 1]))
    end = pattern[end - 1] == '}' ? pattern.rfind('{', end) : end - 1;
  std::size_t begin = end;
  while (begin > begin_of_base && IsDigit(pattern[begin - 1])) --begin;
  if (begin == end) return pattern;
  return pattern.substr(0, begin) + "{frame:" + std::to_string(end - begin) + "}" + pattern.substr(end);
}

std::vector<std::string> CamerasOf(const Inspection& inspection) {
  std::vector<std::string> ids;
  for (const InspectedCamera& camera : inspection.cameras) ids.push_back(camera.id);
  const bool views = !ids.empty() && inspection.cameras.front().format == "opencv_views";
  return views ? NamesOfCameras(ids).cameras : ids;
}

/// A sequence's JSON: the fields of its name and the names of its views.
struct NamedSequence {
  std::string file;
  NameFields fields;
  std::vector<std::string> views;
};

std::vector<NamedSequence> ReadSequences(const std::filesystem::path& path, const std::vector<std::string>& names,
                                         const NamePattern& pattern) {
  std::vector<NamedSequence> sequences;
  for (const std::string& name : names) {
    const std::optional<NameFields> fields = pattern.Match(name);
    const Expected<std::string> bytes = ReadFile(path / name);
    if (!fields || !bytes) continue;
    const Expected<DepthSequence> parsed = ParseDepthSequence(*bytes, name);
    if (!parsed) continue;
    sequences.push_back({name, *fields, {}});
    for (const DepthSequenceView& view : parsed->views) sequences.back().views.push_back(view.name);
  }
  return sequences;
}

/// Values of a name's fields become the fields, longer ones first; what stands in braces stays.
std::string WithFields(const std::string& text, const NameFields& fields) {
  std::vector<std::pair<std::string, std::string>> values;
  for (const auto& [field, value] : fields) values.emplace_back(value, "{" + field + "}");
  std::stable_sort(values.begin(), values.end(),
                   [](const auto& a, const auto& b) { return a.first.size() > b.first.size(); });
  std::string whole = text;
  for (const auto& [value, field] : values) {
    std::string done;
    for (std::size_t at = 0; at < whole.size();) {
      const std::size_t open = std::min(whole.find('{', at), whole.size());
      std::string words = whole.substr(at, open - at);
      ReplaceParts(words, value, field);
      const std::size_t close = std::min(whole.find('}', open), whole.size() - 1);
      done += words + (open < whole.size() ? whole.substr(open, close + 1 - open) : "");
      at = open < whole.size() ? close + 1 : open;
    }
    whole = done;
  }
  return whole;
}

/// Images that are likely the sequence's: in its folder, else anywhere; of these those named like it, if there are any.
std::vector<std::string> ImagesOf(const std::filesystem::path& path, const NamedSequence& sequence) {
  const std::string folder = FolderOf(sequence.file);
  const std::string stem = DisplayPath(std::filesystem::path(sequence.file).stem());
  for (const std::string& below : {folder, std::string()}) {
    for (const std::string& part : {stem, std::string()}) {
      std::vector<std::string> images = ImagesBelow(path / below, true, part);
      if (images.empty()) continue;
      for (std::string& image : images) image = below.empty() ? image : below + "/" + image;
      return images;
    }
  }
  return {};
}

/// Patterns of a sequence's images, simple ones first.
std::vector<std::string> Candidates(const std::vector<std::string>& images, const NamedSequence& sequence) {
  std::vector<std::string> with_fields;
  for (const std::string& image : images) with_fields.push_back(WithFields(image, sequence.fields));
  std::vector<std::string> fields = {"view"};
  const std::size_t width = sequence.views.front().size();
  const auto as_wide = [&](const std::string& view) { return view.size() == width; };
  if (std::all_of(sequence.views.begin(), sequence.views.end(), as_wide)) {
    fields.push_back("view:" + std::to_string(width));
  }
  std::vector<std::string> patterns;
  for (const std::string& view : fields) {
    const std::string guessed = EstimateImages(images, sequence.views, view);
    patterns.push_back(WithFields(guessed, sequence.fields));
    patterns.push_back(EstimateImages(with_fields, sequence.views, view));
    patterns.push_back(guessed);
  }
  return patterns;
}

/// Whether the images are one per view and frame, of every view.
bool Whole(const std::vector<StageInput>& images, const NamedSequence& sequence, const NamePattern& pattern) {
  std::set<std::pair<std::string, std::string>> seen;
  std::set<std::string> views;
  for (const StageInput& image : images) {
    NameFields fields = *pattern.Match(image.name);
    if (!seen.emplace(fields["view"], fields["frame"]).second) return false;
    views.insert(fields["view"]);
  }
  return std::all_of(sequence.views.begin(), sequence.views.end(),
                     [&](const std::string& view) { return views.count(view) != 0; });
}

/// How many of the sequences a pattern gives their images; none where two would share one.
std::size_t Served(const std::vector<NamedSequence>& sequences, const std::filesystem::path& path,
                   const NamePattern& files, const NamePattern& pattern) {
  const Expected<FolderListing> listing = ListFiles(path, pattern.depth());
  if (!listing) return 0;
  const DepthFiles images(listing->files, pattern, files);
  std::set<std::string> taken;
  std::size_t served = 0;
  for (const NamedSequence& sequence : sequences) {
    ItemSpec item;
    images.AddTo(sequence.fields, item);
    for (const StageInput& image : item.inputs) {
      if (!taken.insert(image.name).second) return 0;
    }
    if (Whole(item.inputs, sequence, pattern)) ++served;
  }
  return served;
}

}  // namespace

std::string EstimateImages(const std::vector<std::string>& names, const std::vector<std::string>& cameras,
                           const std::string& field) {
  std::map<std::string, std::size_t> counts;
  for (const std::string& name : names) {
    const std::string pattern = CameraPattern(name, cameras, field);
    if (!pattern.empty()) ++counts[pattern];
  }
  if (counts.empty()) return "";
  return std::max_element(counts.begin(), counts.end(),
                          [](const auto& a, const auto& b) { return a.second < b.second; })
      ->first;
}

bool IsDepthViews(const Inspection& inspection) {
  const auto is_depth = [](const RawCompanion& companion) {
    const std::map<std::string, double> numbers(companion.numbers.begin(), companion.numbers.end());
    const auto holds = [&](const char* key, double value) {
      const auto number = numbers.find(key);
      return number != numbers.end() && number->second == value;
    };
    return companion.format == "png" && holds("bits", 16.0) && holds("channels", 1.0);
  };
  return !inspection.cameras.empty() &&
         std::any_of(inspection.companions.begin(), inspection.companions.end(), is_depth);
}

std::string EstimateDepthBeside(const Proposal& proposal, bool by_recording) {
  if (!IsDepthViews(proposal.inspection)) return "";
  std::string pattern = EstimateImages(ImagesBelow(proposal.folder, true), CamerasOf(proposal.inspection), "camera");
  const std::size_t slash = pattern.find('/');
  if (pattern.find("{frame") == std::string::npos || (by_recording && slash == std::string::npos)) return "";
  return by_recording ? "{recording}" + pattern.substr(slash) : pattern;
}

void ProposeDepthViews(const Proposal& proposal, DeclarationWriter& writer) {
  const std::filesystem::path& path = proposal.folder;
  const std::vector<std::string> cameras = CamerasOf(proposal.inspection);
  const std::vector<std::string> images = ImagesBelow(path, true);
  const std::string pattern = EstimateImages(images, cameras, "camera");
  if (pattern.empty()) {
    writer.Unknown("files", "no name of a depth image holds that of a camera");
  } else {
    writer.Value("files", YamlQuoted(pattern),
                 "what the names have in common of " + std::to_string(images.size()) +
                     " depth images: files that differ in {camera} and {frame} alone are one clip");
  }
  std::vector<std::string> masks;
  for (const std::string& name : ImagesBelow(path, false)) {
    if (name.find("mask") != std::string::npos || name.find("Mask") != std::string::npos) masks.push_back(name);
  }
  if (const std::string mask = EstimateImages(masks, cameras, "camera"); !mask.empty()) {
    writer.Value("mask_files", YamlQuoted(mask), "images that are called masks");
  }
  writer.Value("recording", YamlQuoted("recording"), "a choice: all files are one recording");
  WritePersonAndLabel(false, writer);
  WriteCalibration(proposal, writer);
  writer.Value("depth_unit", "1 mm", "a choice: images do not declare it; most sensors write millimetres");
  if (pattern.find("{frame") != std::string::npos)
    writer.Unknown("rate", "images do not declare it");
  else
    writer.Value("rate", "1 Hz", "a choice: one moment has no rate");
}

Expected<std::string> EstimateDepthFiles(const std::filesystem::path& path, const std::vector<std::string>& names,
                                         const std::string& files) {
  const Expected<NamePattern> own = NamePattern::Parse(files, "ingest.source.files");
  if (!own) return Forward(own);
  const std::vector<NamedSequence> sequences = ReadSequences(path, names, *own);
  std::string best, shared;
  std::size_t most = 0;
  for (const NamedSequence& sequence : sequences) {
    const std::vector<std::string> images =
        sequence.views.empty() ? std::vector<std::string>() : ImagesOf(path, sequence);
    if (images.empty()) continue;
    for (const std::string& text : Candidates(images, sequence)) {
      const Expected<NamePattern> pattern = NamePattern::Parse(text, "ingest.source.depth_files");
      if (!pattern || text.empty()) continue;
      if (shared.empty()) shared = text;
      const std::size_t served = Served(sequences, path, *own, *pattern);
      if (served > most) most = served, best = text;
    }
    break;  // the others' images are named likewise, or there is no pattern
  }
  if (!best.empty()) return best;
  if (shared.empty()) return Fail(ErrorCode::kNotFound, "no 16-bit PNG below the folder is named like a view", files);
  return Fail(ErrorCode::kInconsistent,
              "no pattern gives each of " + std::to_string(sequences.size()) +
                  " files images of its own: those like '" + shared +
                  "' would be shared; put each file beside its images, in a folder that `files` names",
              files);
}

}  // namespace mocurate
