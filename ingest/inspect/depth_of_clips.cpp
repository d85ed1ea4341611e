// The depth images of sequences, recognised by their names: each sequence has its own.

#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include "core/base/file.h"
#include "core/formats/depth_sequence.h"
#include "ingest/folder_listing.h"
#include "ingest/grouped_files.h"
#include "ingest/inspect/declaration_writer.h"
#include "ingest/inspect/file_names.h"
#include "ingest/sources/pattern.h"

namespace mocurate {
namespace {

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
