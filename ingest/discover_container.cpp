#include "ingest/discover_container.h"

#include "core/base/file.h"
#include "ingest/formats/driver.h"
#include "ingest/skipped_files.h"
#include "ingest/sources/source_file.h"

namespace mocurate {

Expected<Discovery> DiscoverContainer(const IngestOptions& options) {
  const SourceOptions& source = options.source;
  const FormatDriver& driver = DriverOf(source.format);
  const std::filesystem::path path = options.path / source.container;
  std::error_code unknown;
  if (!std::filesystem::is_regular_file(path, unknown)) {
    return Fail(ErrorCode::kNotFound, "the file with all clips does not exist", DisplayPath(path),
                "set ingest.path (--set ingest.path=DIR), or correct ingest.source.container");
  }
  const Expected<std::vector<ContainerEntry>> entries = driver.entries(source, options.path);
  if (!entries) return Forward(entries);
  const Expected<NamePattern> pattern = NamePattern::Parse(source.files, "ingest.source.files");
  if (!pattern) return Forward(pattern);
  Discovery discovery;
  std::set<std::string> recordings;
  const ItemOptions stage_options = OptionsToJson(source);
  for (std::size_t i = 0; i < entries->size(); ++i) {
    const ContainerEntry& entry = (*entries)[i];
    const Expected<NamedFile> named = ReadName(source, entry.name);
    if (!named && named.error().code == ErrorCode::kConfig) return Forward(named);
    const std::optional<Error> ambiguous = AmbiguousName(source, *pattern, entry.name);
    if (!named || ambiguous) {
      discovery.excluded.push_back(ambiguous ? RefusedFile(entry.name, kNameAmbiguous, *ambiguous)
                                             : SkippedFile(entry.name, source, true, named.error()));
      continue;
    }
    recordings.insert(named->identity.recording);
    if (!entry.excluded.empty()) {
      discovery.excluded.push_back(
          ExcludedFile(named->item(), entry.name, "excluded", entry.excluded, "as the set's papers do"));
      continue;
    }
    if (const auto excluded = source.exclude.find(named->identity.recording); excluded != source.exclude.end()) {
      discovery.excluded.push_back(
          ExcludedFile(named->item(), entry.name, "excluded", excluded->second, "ingest.source.exclude names it"));
      continue;
    }
    // Clips of a dataset keep their ids: several may be spans of one recording.
    const std::string name = driver.stored ? entry.name : named->item();
    ItemSpec item{name, stage_options, {{"source", source.container, path, ""}}};
    item.options.Set("entry", i);
    item.options.Set("entry_name", entry.name);
    if (entry.frames > 0) item.options.Set("most_frames", entry.frames);
    if (!entry.label.empty()) {
      const Expected<std::string> label = LabelOf(source, entry.label, entry.name);
      if (!label) {
        discovery.excluded.push_back(SkippedFile(entry.name, source, true, label.error()));
        continue;
      }
      item.options.Set("label_override", *label);
    }
    discovery.persons.insert(named->identity.person);
    discovery.performers.insert(named->performer);
    if (!driver.stored) discovery.styles.insert(named->style);  // a stored clip has its own
    discovery.items.push_back(std::move(item));
  }
  if (discovery.items.empty()) {
    return Fail(ErrorCode::kNotFound, "no clip of the file matches the pattern '" + source.files + "'",
                DisplayPath(path), "correct ingest.source.files");
  }
  NoteUnmatched(source, recordings, discovery.findings);
  return discovery;
}

}  // namespace mocurate
