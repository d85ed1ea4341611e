// Folders of depth images: what their names say, and the declaration of those that stand beside calibrations alone.

#include <algorithm>
#include <cctype>
#include <map>

#include "core/base/file.h"
#include "core/formats/png.h"
#include "ingest/folder_listing.h"
#include "ingest/inspect/declaration_writer.h"
#include "ingest/inspect/file_kind.h"
#include "ingest/inspect/file_names.h"
#include "ingest/inspect/gathered_names.h"

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

}  // namespace

void ReplaceParts(std::string& text, const std::string& from, const std::string& to) {
  for (std::size_t at = FindPart(text, from, 0); at != std::string::npos; at = FindPart(text, from, at + to.size())) {
    text.replace(at, from.size(), to);
  }
}

std::vector<std::string> ImagesBelow(const std::filesystem::path& folder, bool depth, const std::string& part) {
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

std::string EstimateDepthBeside(const Inspection& inspection, const std::filesystem::path& path, bool by_recording) {
  if (!IsDepthViews(inspection)) return "";
  std::string pattern = EstimateImages(ImagesBelow(path, true), CamerasOf(inspection), "camera");
  const std::size_t slash = pattern.find('/');
  if (pattern.find("{frame") == std::string::npos || (by_recording && slash == std::string::npos)) return "";
  return by_recording ? "{recording}" + pattern.substr(slash) : pattern;
}

void WriteDepthViews(const Inspection& inspection, const std::filesystem::path& path, DeclarationWriter& writer) {
  const std::vector<std::string> cameras = CamerasOf(inspection);
  const std::vector<std::string> images = ImagesBelow(path, true);
  const std::string pattern = EstimateImages(images, cameras, "camera");
  if (pattern.empty()) {
    writer.Unknown("files", "no name of a depth image holds that of a camera");
  } else {
    writer.Value("files", YamlQuoted(pattern),
                 "guessed from the names of " + std::to_string(images.size()) +
                     " depth images: files that differ in {camera} and {frame} alone are one clip");
  }
  std::vector<std::string> masks;
  for (const std::string& name : ImagesBelow(path, false)) {
    if (name.find("mask") != std::string::npos || name.find("Mask") != std::string::npos) masks.push_back(name);
  }
  if (const std::string mask = EstimateImages(masks, cameras, "camera"); !mask.empty()) {
    writer.Value("mask_files", YamlQuoted(mask), "guessed from the names: images that are called masks");
  }
  writer.Value("recording", YamlQuoted("recording"), "a choice: all files are one recording");
  writer.Value("person", YamlQuoted("unknown"), "unknown: write who performs");
  writer.Value("label", YamlQuoted(""), "unknown: the names do not declare it");
  writer.Value("other_files", "ignore", "a choice: `error` refuses files that the pattern does not match");
  writer.Value("licence", "\"\"", "unknown: no file declares it");
  WriteCalibration(inspection, path, writer);
  writer.Value("depth_unit", "1 mm", "a choice: images do not declare it; most sensors write millimetres");
  if (pattern.find("{frame") != std::string::npos)
    writer.Unknown("rate", "images do not declare it");
  else
    writer.Value("rate", "1 Hz", "a choice: one moment has no rate");
}

}  // namespace mocurate
