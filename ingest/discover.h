#pragma once

#include <optional>
#include <set>
#include <string>
#include <vector>

#include "core/base/finding.h"
#include "core/pipeline/runner.h"
#include "ingest/options.h"

namespace mocurate {

/// Code of the finding about a folder whose files lie where the pattern does not look: no clip.
inline constexpr const char* kFolderNotRead = "folder_not_read";

/// Code of the finding about a name that fits the pattern in two ways: the file is refused.
inline constexpr const char* kNameAmbiguous = "name_ambiguous";

/// Code of the finding about an array of another number of joints than the source's.
inline constexpr const char* kOtherJoints = "other_joints";

/// What a source folder holds: one item per clip for the stage `ingest` (item = clip id, input role "source"), and what
/// became of every file that is no such item: kExcluded when ingest.source.other_files says that such files are passed
/// over, kRefused when it asks for an error or the name declares a label that there is not. One finding each; files
/// that lie where the pattern does not look are one finding per folder, which counts them.
struct Discovery {
  std::vector<ItemSpec> items;  ///< sorted by item
  std::vector<ItemResult> excluded;
  std::set<std::string> persons;     ///< who performs in the items
  std::set<std::string> performers;  ///< the same as ingest.source.roles names them: without {body}
  std::set<std::string> styles;      ///< of the items, "" for those without
  std::vector<Finding> findings;     ///< about the declaration: names in it that nothing has
  std::vector<ItemSpec> truth;       ///< items for the stage `truth`, when the source knows its truth
};

/// The declaration as the items of Discover have it in their options, beside facts of their own: where the path is a
/// file, its name is that of the container.
SourceOptions DeclaredOfItems(const IngestOptions& options);

/// Lists files; reads names, of the contents only those of ingest.source.annotations and a few beginnings: where these
/// are all of another format than the declared one, that is an error kConfig. With `only`, files of other
/// names do not exist for it. A path that is a file stands for its folder and that file alone. Error kNotFound,
/// kConfig.
Expected<Discovery> Discover(const IngestOptions& options, const std::optional<std::set<std::string>>& only = {});

}  // namespace mocurate
