#include "ingest/discover.h"

#include <algorithm>
#include <tuple>

#include "core/base/file.h"
#include "core/base/text.h"
#include "ingest/chosen_clips.h"
#include "ingest/folder_listing.h"
#include "ingest/formats/driver.h"
#include "ingest/grouped_files.h"
#include "ingest/item_facts.h"
#include "ingest/known_issues.h"
#include "ingest/skipped_files.h"
#include "ingest/sources/array_clips.h"
#include "ingest/sources/babel_segments.h"
#include "ingest/sources/source_file.h"

namespace mocurate {
namespace {

/// Every {field} that names a clip must be one of the pattern: a misspelt one would put all people under one name. The
/// default texts of a declaration may become empty.
Status CheckFields(const SourceOptions& source, const NamePattern& pattern) {
  const SourceOptions defaults;
  std::vector<std::string> known = pattern.FieldNames();
  known.insert(known.end(), {"file", "body"});
  const std::tuple<const char*, const std::string*, const std::string*> texts[] = {
      {"person", &source.person, &defaults.person},    {"recording", &source.recording, &defaults.recording},
      {"label", &source.label, &defaults.label},       {"fine_label", &source.fine_label, &defaults.fine_label},
      {"session", &source.session, &defaults.session}, {"view", &source.view, &defaults.view},
      {"style", &source.style, &defaults.style}};
  for (const auto& [option, text, by_default] : texts) {
    if (*text == *by_default) continue;
    for (const std::string& field : FieldsOf(*text)) {
      if (std::find(known.begin(), known.end(), field) != known.end()) continue;
      const std::optional<std::string> near = Nearest(field, known);
      std::string list;
      for (const std::string& name : known) list += (list.empty() ? "{" : ", {") + name + "}";
      return Fail(ErrorCode::kConfig,
                  "'" + *text + "' names the field {" + field + "}, which '" + pattern.text() + "' does not have",
                  std::string("ingest.source.") + option,
                  near ? "did you mean {" + *near + "}?" : "its fields are " + list);
    }
  }
  return {};
}

/// ingest.source.label_table: motion -> label text. A header and lines "motion,label", or, as in CMU's index of its
/// motions, rows "motion<tab>text", where lines without a tab are headings. Error kMalformed "name:line".
Expected<std::map<std::string, std::string>> ReadLabelTable(const IngestOptions& options) {
  std::map<std::string, std::string> table;
  const std::string& name = options.source.label_table;
  if (name.empty()) return table;
  const Expected<std::string> bytes = ReadFile(options.path / name);
  if (!bytes) {
    return Fail(bytes.error().code, "the table of labels cannot be read: " + bytes.error().what, name,
                "put it there, or correct ingest.source.label_table");
  }
  const bool headed = bytes->substr(0, bytes->find('\n')).find(',') != std::string::npos;
  const bool tabbed = !headed && bytes->find('\t') != std::string::npos;
  const std::vector<std::string_view> lines = SplitText(*bytes, '\n');
  for (std::size_t i = tabbed ? 0 : 1; i < lines.size(); ++i) {
    std::vector<std::string_view> cells;
    for (const std::string_view cell : SplitText(Trim(lines[i]), tabbed ? '\t' : ',')) {
      if (!tabbed || !Trim(cell).empty()) cells.push_back(Trim(cell));
    }
    if (tabbed ? cells.size() < 2 : cells.size() == 1 && cells[0].empty()) continue;
    const std::string where = name + ":" + std::to_string(i + 1);
    if (!tabbed && cells.size() != 2) {
      return Fail(ErrorCode::kMalformed, "a line has " + std::to_string(cells.size()) + " cells", where,
                  "each is 'motion,label'");
    }
    if (!table.emplace(cells[0], cells[1]).second) {
      return Fail(ErrorCode::kMalformed, "the motion '" + std::string(cells[0]) + "' occurs twice", where,
                  "a motion has one label");
    }
  }
  return table;
}

std::string TextOf(const KnownIssue& issue) { return issue.kind + ": " + issue.note + " (" + issue.source + ")"; }

/// The file's name without folders and ending.
std::string StemOf(const std::string& name) { return std::filesystem::path(name).stem().string(); }

/// Whether a folder lies in one that is named like the recording of a clip: what is there are parts of it.
bool BelongsToClip(const std::string& folder, const std::vector<ItemSpec>& items) {
  std::set<std::string> recordings;
  for (const ItemSpec& item : items) recordings.insert(RecordingOf(item));
  const std::vector<std::string_view> parts = SplitText(folder, '/');
  return std::any_of(parts.begin(), parts.end(),
                     [&](std::string_view part) { return recordings.count(std::string(part)) != 0; });
}

/// Makes items of names: of the files of a folder, or of the clips in one file.
class ClipFinder {
 public:
  ClipFinder(const IngestOptions& options, const NamePattern& pattern)
      : options_(options),
        source_(options.source),
        driver_(DriverOf(options.source.format)),
        pattern_(pattern),
        declared_(OptionsToJson(options.source)) {}

  /// The clips of a file that holds them all. Error kNotFound, and of the container.
  Status InContainer();
  /// The clips below a folder; with `only` of those files alone. Errors of the folder and of what the declaration
  /// names.
  Status InFolder(const std::optional<std::set<std::string>>& only);
  Discovery discovery;

 private:
  void Exclude(const std::filesystem::path& file, ItemResult result);
  std::optional<NamedFile> Name(const std::string& name, bool matches, const std::filesystem::path& file,
                                ItemFacts& facts, Status& broken);
  bool SetLabel(const std::string& text, const std::string& name, const std::filesystem::path& file, ItemFacts& facts);
  Status TakeFile(const FolderFile& file);
  bool AddCompanions(const FolderFile& file, const NamedFile& named, ItemSpec& item);
  void AddClips(const FolderFile& file, const NamedFile& named, ItemFacts facts, const ItemSpec& item);
  void AddFoldersBelow();

  const IngestOptions& options_;
  const SourceOptions& source_;
  const FormatDriver& driver_;
  const NamePattern& pattern_;
  const ItemOptions declared_;
  KnownIssues known_issues_;
  std::set<std::string> recordings_;
  // Of a folder.
  std::vector<FolderFile> files_;
  NamePattern depth_pattern_, skeleton_pattern_;
  std::map<std::string, std::string> table_;
  std::optional<BabelIndex> babel_;
  GroupedFiles gathered_;
  std::optional<DepthFiles> depth_files_;
  std::map<std::string, std::size_t> elsewhere_;  ///< files that lie where the pattern does not look, by folder
  std::vector<std::string> passed_over_;
};

void ClipFinder::Exclude(const std::filesystem::path& file, ItemResult result) {
  if (IsFailure(result.outcome.kind) && !file.empty()) AddSourceHash(file, result);
  discovery.excluded.push_back(std::move(result));
}

/// What a name says of its clip; nothing where it is excluded, which is reported. `matches`: the pattern.
std::optional<NamedFile> ClipFinder::Name(const std::string& name, bool matches, const std::filesystem::path& file,
                                          ItemFacts& facts, Status& broken) {
  Expected<NamedFile> named = ReadName(source_, name);
  if (!named && named.error().code == ErrorCode::kConfig) {
    broken = Forward(named);
    return std::nullopt;
  }
  std::optional<Error> ambiguous;
  for (const std::string& own : gathered_.NamesOf(name)) {
    if (!ambiguous) ambiguous = AmbiguousName(source_, pattern_, own);
  }
  const auto refuse = [&] { Exclude(file, RefusedFile(name, kNameAmbiguous, *ambiguous)); };
  if (!named) {
    recordings_.insert(StemOf(name));  // excluded anyway
    ambiguous ? refuse() : Exclude(file, SkippedFile(name, source_, matches, named.error()));
    return std::nullopt;
  }
  const std::string recording = source_.views.multi_view ? StemOf(name) : named->identity.recording;
  recordings_.insert(recording);
  if (const auto excluded = source_.exclude.find(recording); excluded != source_.exclude.end()) {
    Exclude(file, ExcludedFile(named->item(), name, "excluded", excluded->second, "ingest.source.exclude names it"));
    return std::nullopt;
  }
  const std::optional<KnownIssue> issue = known_issues_.Find(recording);
  if (issue && source_.known_issues == KnownIssueAction::kDrop) {
    Exclude(file, ExcludedFile(named->item(), name, "known_issue", TextOf(*issue),
                               "ingest.source.known_issues: report keeps such clips"));
    return std::nullopt;
  }
  if (issue && source_.known_issues == KnownIssueAction::kReport) facts.known_issue = TextOf(*issue);
  if (!ambiguous) return *std::move(named);
  refuse();
  return std::nullopt;
}

/// False where the text is of no label, which is reported.
bool ClipFinder::SetLabel(const std::string& text, const std::string& name, const std::filesystem::path& file,
                          ItemFacts& facts) {
  Expected<std::string> label = LabelOf(source_, text, name);
  facts.labelled = label.has_value();
  if (label)
    facts.label = *std::move(label);
  else
    Exclude(file, SkippedFile(name, source_, true, label.error()));
  return facts.labelled;
}

Status ClipFinder::InContainer() {
  const std::filesystem::path path = options_.path / source_.container;
  std::error_code unknown;
  if (!std::filesystem::is_regular_file(path, unknown)) {
    return Fail(ErrorCode::kNotFound, "the file with all clips does not exist", DisplayPath(path),
                "set ingest.path (--set ingest.path=DIR), or correct ingest.source.container");
  }
  const Expected<std::vector<ContainerEntry>> entries = driver_.entries(source_, options_.path);
  if (!entries) return Forward(entries);
  for (std::size_t i = 0; i < entries->size(); ++i) {
    const ContainerEntry& entry = (*entries)[i];
    Status broken;
    ItemFacts facts;
    const std::optional<NamedFile> named = Name(entry.name, true, {}, facts, broken);
    if (!broken) return broken;
    if (!named) continue;
    if (!entry.excluded.empty()) {
      Exclude({}, ExcludedFile(named->item(), entry.name, "excluded", entry.excluded, "as the set's papers do"));
      continue;
    }
    facts.entry = static_cast<std::int64_t>(i);
    facts.entry_name = entry.name;
    facts.most_frames = entry.frames;
    if (!entry.label.empty() && !SetLabel(entry.label, entry.name, {}, facts)) continue;
    discovery.persons.insert(named->identity.person);
    discovery.performers.insert(named->performer);
    if (!driver_.stored) discovery.styles.insert(named->style);  // a stored clip has its own
    // Clips of a dataset keep their ids: several may be spans of one recording.
    ItemSpec item{driver_.stored ? entry.name : named->item(), declared_, {{"source", source_.container, path, ""}}};
    SetFacts(facts, item);
    discovery.items.push_back(std::move(item));
  }
  if (discovery.items.empty()) {
    return Fail(ErrorCode::kNotFound, "no clip of the file matches the pattern '" + source_.files + "'",
                DisplayPath(path), "correct ingest.source.files");
  }
  NoteUnmatched(source_, recordings_, discovery.findings);
  return {};
}

/// Calibrations, frames, skeleton and depth images of a file; false where one is missing, which is reported.
bool ClipFinder::AddCompanions(const FolderFile& file, const NamedFile& named, ItemSpec& item) {
  if (Status added = gathered_.AddInputs(file.name, named.fields, item); !added) {
    const char* code = added.error().code == ErrorCode::kNotFound ? "calibration_missing" : "unreadable_file";
    Exclude(file.path, RefusedFile(item.item, code, added.error()));
    return false;
  }
  if (!source_.skeleton_files.empty()) {
    const std::string name = FillFields(source_.skeleton_files, named.fields);
    const auto skeleton =
        std::find_if(files_.begin(), files_.end(), [&](const FolderFile& other) { return other.name == name; });
    if (skeleton == files_.end()) {
      Exclude(file.path, RefusedFile(item.item, "skeleton_file_missing",
                                     {ErrorCode::kNotFound, "its skeleton file '" + name + "' is not in the folder",
                                      file.name, "put it there, or correct ingest.source.skeleton_files"}));
      return false;
    }
    item.inputs.push_back({"skeleton_file", skeleton->name, skeleton->path, ""});
  }
  if (driver_.has_truth) discovery.truth.push_back(item);
  if (depth_files_) depth_files_->AddTo(named.fields, item);
  return true;
}

/// An item for each person of the file, and for each clip of a file of arrays.
void ClipFinder::AddClips(const FolderFile& file, const NamedFile& named, ItemFacts facts, const ItemSpec& item) {
  std::vector<ArrayClip> clips;
  if (driver_.holds_clips) clips = ArrayClipsOf(file.path, file.name);
  if (clips.empty() || (clips.size() == 1 && clips[0].id.empty())) clips = {ArrayClip()};
  const bool whole = clips.size() == 1 && clips[0].id.empty();
  std::size_t wanted = source_.joints.size();
  if (!whole && source_.joints.empty()) {
    const Expected<SkeletonPtr> skeleton = SourceSkeleton(source_);
    wanted = skeleton && *skeleton ? (*skeleton)->joints.size() : 0;
  }
  for (int body = 1; body <= named.bodies; ++body) {
    const Expected<NamedFile> person = ReadName(source_, file.name, body);
    discovery.persons.insert(person ? person->identity.person : named.identity.person);
    if (named.bodies > 1) facts.body = body;
    for (const ArrayClip& clip : clips) {
      ItemSpec one = item;
      if (named.bodies > 1 && person) one.item = person->item();
      one.item += RecordingSuffix(clip.id);
      ItemFacts of_clip = facts;
      of_clip.array = clip.id;
      if (!clip.label.empty() && !facts.labelled && !SetLabel(clip.label, file.name + clip.id, {}, of_clip)) continue;
      if (!whole && clip.joints != wanted) {
        Exclude({}, ExcludedFile(one.item, file.name + clip.id, kOtherJoints,
                                 "it has " + std::to_string(clip.joints) + " joints, those of the source have " +
                                     std::to_string(wanted),
                                 "declare it as a source of its own"));
        continue;
      }
      SetFacts(of_clip, one);
      discovery.items.push_back(std::move(one));
    }
  }
}

Status ClipFinder::TakeFile(const FolderFile& file) {
  const bool companion = (depth_files_ && depth_pattern_.Match(file.name)) || gathered_.BelongsToOtherClip(file.name) ||
                         (!source_.skeleton_files.empty() && skeleton_pattern_.Match(file.name)) ||
                         std::count(source_.annotations.begin(), source_.annotations.end(), file.name) > 0 ||
                         file.name == source_.label_table;
  if (companion) return {};
  const bool matches = pattern_.Match(file.name).has_value();
  if (!matches && source_.other_files == OtherFiles::kIgnore) {
    if (EndsAsMotion(source_, file.name)) passed_over_.push_back(file.name);
    return {};
  }
  const int depth = DepthOf(file.name);
  if (!matches && (depth < pattern_.least_depth() || depth > pattern_.depth())) {
    ++elsewhere_[depth == 0 ? "." : file.name.substr(0, file.name.rfind('/'))];
    return {};
  }
  Status broken;
  ItemFacts facts;
  const std::optional<NamedFile> named = Name(file.name, matches, file.path, facts, broken);
  if (!named) return broken;
  if (!file.problem.empty() && gathered_.empty()) {
    const Error why{ErrorCode::kUnreadable, file.problem, file.name, "correct or remove it"};
    Exclude(file.path, RefusedFile(named->item(), "unreadable_file", why));
    return {};
  }
  if (!source_.label_table.empty()) {
    const auto row = table_.find(StemOf(file.name));
    if (row == table_.end()) {
      Exclude(file.path, SkippedFile(file.name, source_, true,
                                     {ErrorCode::kInconsistent, "'" + source_.label_table + "' does not name it",
                                      file.name, "add a line, or take the file out"}));
      return {};
    }
    if (!SetLabel(row->second, file.name, file.path, facts)) return {};
    if (facts.label != row->second) facts.label_text = row->second;
  }
  if (const IndexedSequence* annotated = babel_->Find(file.name)) {
    facts.annotation = EncodeBabel({annotated->sequence});
    const auto role = source_.annotation_roles.find(annotated->file);
    if (role != source_.annotation_roles.end()) facts.role = role->second;
  }
  ItemSpec item{named->item(), declared_, {{"source", file.name, file.path, ""}}};
  SetFacts(facts, item);
  if (!AddCompanions(file, *named, item)) return {};
  discovery.performers.insert(named->performer);
  discovery.styles.insert(named->style);
  AddClips(file, *named, facts, item);
  return {};
}

/// Folders that the pattern does not look into, or that it takes for files.
void ClipFinder::AddFoldersBelow() {
  for (const auto& [folder, count] : elsewhere_) {
    const bool named_so = pattern_.Match(folder).has_value();
    const bool defaults = source_.other_files == OtherFiles::kIgnore || count == 0;
    if (!named_so && (defaults || BelongsToClip(folder, discovery.items))) continue;
    discovery.excluded.push_back(SkippedFolder(folder, count, named_so, source_));
  }
}

Status ClipFinder::InFolder(const std::optional<std::set<std::string>>& only) {
  Expected<std::map<std::string, std::string>> table = ReadLabelTable(options_);
  if (!table) return Forward(table);
  Expected<NamePattern> depth = NamePattern::Parse(source_.depth_files, "ingest.source.depth_files");
  if (!depth) return Forward(depth);
  Expected<NamePattern> skeletons = NamePattern::Parse(source_.skeleton_files, "ingest.source.skeleton_files");
  if (!skeletons) return Forward(skeletons);
  Expected<FolderListing> listing = ListFiles(
      options_.path, std::max({pattern_.depth(), depth->depth(), skeletons->depth(), GroupedFiles::Depth(source_)}));
  if (!listing) return Forward(listing);
  Expected<KnownIssues> known_issues = KnownIssues::Load(source_.known_issue_lists);
  if (!known_issues) return Forward(known_issues);
  if (Status rules = CheckLabelRules(source_); !rules) return rules;
  Expected<BabelIndex> babel = BabelIndex::Read(options_.path, source_.annotations);
  if (!babel) return Forward(babel);
  files_ = std::move(listing->files);
  Expected<GroupedFiles> gathered = GroupedFiles::Of(source_, pattern_, files_);
  if (!gathered) return Forward(gathered);
  table_ = std::move(*table), depth_pattern_ = std::move(*depth), skeleton_pattern_ = std::move(*skeletons);
  elsewhere_ = std::move(listing->folders_below), known_issues_ = std::move(*known_issues);
  babel_ = std::move(*babel), gathered_ = std::move(*gathered);
  if (driver_.has_truth || (source_.views.multi_view && !source_.depth_files.empty()))
    depth_files_.emplace(files_, depth_pattern_, pattern_);
  std::vector<std::string> names;
  for (const FolderFile& file : files_) {
    if (only && only->count(file.name) == 0) continue;
    names.push_back(file.name);
    if (Status taken = TakeFile(file); !taken) return taken;
  }
  if (!only) AddFoldersBelow();
  if (discovery.items.empty()) return tl::unexpected<Error>(NothingFound(options_, discovery, names));
  NoteUnmatched(source_, recordings_, discovery.findings);
  NotePassedOver(source_, passed_over_, discovery.findings);
  if (!babel_->Unused().empty()) discovery.excluded.push_back(WithoutMotion(*babel_, source_.annotations));
  return source_.views.multi_view ? GroupViews(source_, discovery.items) : Status();
}

/// Items that several files or entries would give under one name. Error kConfig.
Status SortItems(Discovery& discovery) {
  const auto by_item = [](const ItemSpec& a, const ItemSpec& b) { return a.item < b.item; };
  std::sort(discovery.items.begin(), discovery.items.end(), by_item);
  std::sort(discovery.truth.begin(), discovery.truth.end(), by_item);
  for (std::size_t i = 1; i < discovery.items.size(); ++i) {
    const ItemSpec& a = discovery.items[i - 1];
    const ItemSpec& b = discovery.items[i];
    if (b.item != a.item) continue;
    const auto name = [](const ItemSpec& item) {
      const std::string entry = FactsOf(item).entry_name;
      return entry.empty() ? item.inputs[0].name : entry;
    };
    return Fail(ErrorCode::kConfig, "'" + name(a) + "' and '" + name(b) + "' are both '" + b.item + "'",
                "ingest.source.recording", "use more fields of the name in `recording`");
  }
  return {};
}

/// A path that is one file stands for its folder and that file alone. Nothing for a folder.
std::optional<IngestOptions> FolderOfFile(const IngestOptions& options, int depth,
                                          std::optional<std::set<std::string>>& only) {
  std::error_code unknown;
  if (!std::filesystem::is_regular_file(options.path, unknown)) return std::nullopt;
  const std::filesystem::path file = std::filesystem::absolute(options.path, unknown).lexically_normal();
  IngestOptions whole = options;
  whole.path = file.parent_path();
  whole.source = DeclaredOfItems(options);
  if (!options.source.container.empty()) return whole;
  for (int i = 0; i < depth; ++i) whole.path = whole.path.parent_path();
  only = {DisplayPath(file.lexically_relative(whole.path))};
  return whole;
}

/// The clips of a declaration that is sound; `only`: of those files of the folder.
Expected<Discovery> Find(const IngestOptions& options, const NamePattern& pattern,
                         const std::optional<std::set<std::string>>& only) {
  ClipFinder finder(options, pattern);
  Status found = options.source.container.empty() ? finder.InFolder(only) : finder.InContainer();
  if (found) found = SortItems(finder.discovery);
  if (found) found = CheckOwnImages(options.source, finder.discovery.items);
  if (found && options.source.container.empty()) found = CheckFormat(options.source, finder.discovery.items);
  if (!found) return Forward(found);
  return std::move(finder.discovery);
}

}  // namespace

SourceOptions DeclaredOfItems(const IngestOptions& options) {
  SourceOptions source = options.source;
  std::error_code unknown;
  if (!source.container.empty() && std::filesystem::is_regular_file(options.path, unknown))
    source.container = options.path.filename().string();
  return source;
}

Expected<Discovery> Discover(const IngestOptions& options, const std::optional<std::set<std::string>>& only) {
  const SourceOptions& source = options.source;
  if (Status ok = CheckSource(source); !ok) return Forward(ok);
  const Expected<AxisConvention> axes = AxisConvention::Parse(source.axes);
  if (!axes) return Forward(axes);
  const Expected<SkeletonPtr> skeleton = SourceSkeleton(source);
  if (!skeleton) return Forward(skeleton);
  const Expected<NamePattern> pattern = NamePattern::Parse(source.files, "ingest.source.files");
  if (!pattern) return Forward(pattern);
  if (Status fields = CheckFields(source, *pattern); !fields) return Forward(fields);
  std::optional<std::set<std::string>> names = only;
  const std::optional<IngestOptions> whole = FolderOfFile(options, pattern->least_depth(), names);
  return Find(whole ? *whole : options, *pattern, names);
}

}  // namespace mocurate
