#pragma once

#include <filesystem>

#include "core/motion/skeleton.h"
#include "core/store/hdf5_file.h"
#include "core/store/table.h"

namespace mocurate::store {

/// Sets /@schema, /@units and /@content_sha256, checks `content` against the table (error kInconsistent) and writes the
/// file whole or not at all (error kCannotWrite).
Status WriteContent(const Schema& schema, Content content, const std::filesystem::path& path);

/// Reads every field of the table that is there, checks all of them and the hashes. Error kNotFound, kUnreadable,
/// kMalformed with "file:/dataset" as place.
Expected<Content> ReadContent(const Schema& schema, const std::filesystem::path& path);
Expected<Content> ReadContent(const Schema& schema, const Hdf5Reader& reader);

/// Parts of ReadContent, for who reads a file piece by piece: the schema's name; the hash of a field, with the one
/// beside it, if there is one; the lines (by path) of all fields, with /@content_sha256. Error kMalformed.
Status CheckSchemaName(const Schema& schema, const Hdf5Reader& reader);
Status CheckHash(const Hdf5Reader& reader, const std::string& path, const std::string& sha256);
Status CheckContentHash(const Hdf5Reader& reader, const Content& content,
                        const std::map<std::string, std::string>& lines);

/// Skeleton::Check with the place in a file.
Status CheckSkeleton(const Skeleton& skeleton, ErrorCode code, const std::filesystem::path& path,
                     const std::string& prefix);

}  // namespace mocurate::store
