#pragma once

#include <filesystem>
#include <map>

#include "core/base/sha256.h"
#include "core/motion/skeleton.h"
#include "core/store/hdf5_file.h"
#include "core/store/table.h"

namespace mocurate::store {

/// Writes a file of fields whose rows may be appended later; the file appears atomically.
class ContentWriter {
 public:
  /// Sets /@schema, /@units and /@content_sha256, checks `content` against the table (error kInconsistent) and writes
  /// all but the rows of Content::later. Error kCannotWrite.
  static Expected<ContentWriter> Create(const Schema& schema, Content content, const std::filesystem::path& path);
  /// The next rows of a field of Content::later, whose rules have been checked. Error kCannotWrite; kInternal: more
  /// than were announced.
  Status Append(const std::string& field, const Array& rows);
  /// The same of a field of Content::extra.
  Status AppendExtra(const std::string& field, const ExtraField& rows);
  /// Error kCannotWrite; kInconsistent: rows are missing.
  Status Finish();

 private:
  /// A field whose rows come.
  struct Growing {
    Array shape;  ///< without values
    std::uint64_t rows = 0;
    Sha256 hasher;
  };
  ContentWriter(std::filesystem::path path, Hdf5Writer writer) : path_(std::move(path)), writer_(std::move(writer)) {}
  Status WriteFields(const Schema& schema, Content content);
  Status WriteExtra(const ExtraFields& extra);

  std::filesystem::path path_;
  Hdf5Writer writer_;
  std::map<std::string, Growing> growing_;
  std::map<std::string, std::pair<ExtraField, std::uint64_t>> growing_extra_;  ///< shape, and rows that came
  std::map<std::string, std::string> lines_;
};

/// A ContentWriter's work, where nothing comes later.
Status WriteContent(const Schema& schema, Content content, const std::filesystem::path& path);

/// Reads every field of the table that is there, checks all of them and the hashes. Error kNotFound, kUnreadable,
/// kMalformed with "file:/dataset" as place.
Expected<Content> ReadContent(const Schema& schema, const std::filesystem::path& path);
Expected<Content> ReadContent(const Schema& schema, const Hdf5Reader& reader);

/// Parts of ReadContent, for incremental readers: the schema's name; the hash of a field, with the one
/// beside it, if there is one; the lines (by path) of all fields, with /@content_sha256. Error kMalformed.
Status CheckSchemaName(const Schema& schema, const Hdf5Reader& reader);
Status CheckHash(const Hdf5Reader& reader, const std::string& path, const std::string& sha256);
Status CheckContentHash(const Hdf5Reader& reader, const Content& content,
                        const std::map<std::string, std::string>& lines);

/// Skeleton::Check with the place in a file.
Status CheckSkeleton(const Skeleton& skeleton, ErrorCode code, const std::filesystem::path& path,
                     const std::string& prefix);

}  // namespace mocurate::store
