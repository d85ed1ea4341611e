#include "core/store/content_file.h"

namespace mocurate::store {
namespace {

using Lines = std::map<std::string, std::string>;

/// The splits' names become paths: no empty ones, no slash.
Status CheckSplitNames(const Content& content, const std::filesystem::path& path) {
  for (const std::string& name : content.splits) {
    if (!name.empty() && name != "." && name.find('/') == std::string::npos && name.find('\0') == std::string::npos) {
      continue;
    }
    return Fail(ErrorCode::kInconsistent, "'" + name + "' is not a name for a split", Where(path, "/splits"),
                "use a name without '/'");
  }
  return {};
}

}  // namespace

Status CheckHash(const Hdf5Reader& reader, const std::string& path, const std::string& sha256) {
  if (path.rfind("/@", 0) == 0) return {};
  const auto stored = reader.AttributeOf(path, "sha256");
  if (!stored || *stored == sha256) return {};
  return Fail(ErrorCode::kMalformed, "its values do not have the stored sha256; they were changed after writing",
              Where(reader.file(), path), "make the file again, or copy it again");
}

Status CheckContentHash(const Hdf5Reader& reader, const Content& content,
                        const std::map<std::string, std::string>& lines) {
  const std::string actual = ContentSha256(lines);
  if (content.Text("/@content_sha256") == actual) return {};
  return Fail(ErrorCode::kMalformed, "is not the hash of the content, which is " + actual,
              Where(reader.file(), "/@content_sha256"), "a field or an attribute was changed after writing");
}

Status CheckSchemaName(const Schema& schema, const Hdf5Reader& reader) {
  if (!reader.Has("/@schema")) return {};
  const auto name = reader.Read("/@schema", FieldType::kText);
  if (!name) return Forward(name);
  const std::string& found = name->as<std::string>()[0];
  if (found == schema.name) return {};
  return Fail(ErrorCode::kMalformed, "the file is '" + found + "'; '" + schema.name + "' was expected",
              Where(reader.file(), "/@schema"),
              AreVersions(found, schema.name) ? schema.MakeAgain() : "give a file with the right schema");
}

Expected<ContentWriter> ContentWriter::Create(const Schema& schema, Content content,
                                              const std::filesystem::path& path) {
  content.PutText("/@schema", schema.name);
  content.PutText("/@units", "m s rad");
  content.PutText("/@content_sha256", std::string(64, '0'));
  if (Status checked = CheckSplitNames(content, path); !checked) return Forward(checked);
  const auto where = [&path](const std::string& field) { return Where(path, field); };
  if (Status checked = CheckContent(schema, content, ErrorCode::kInconsistent, where); !checked) {
    return Forward(checked);
  }
  auto writer = Hdf5Writer::Create(path);
  if (!writer) return Forward(writer);
  ContentWriter made(path, std::move(*writer));
  if (Status written = made.WriteFields(schema, std::move(content)); !written) return Forward(written);
  return made;
}

/// Attributes follow their datasets: so are the paths sorted.
Status ContentWriter::WriteExtra(const ExtraFields& extra) {
  for (const auto& [path, field] : extra) {
    const bool whole = field.HasValues();
    if (Status made = whole ? writer_.WriteExtra(path, field) : writer_.MakeExtra(path, field); !made) return made;
    if (!whole) growing_extra_[path].first = field;
  }
  return {};
}

Status ContentWriter::WriteFields(const Schema& schema, Content content) {
  for (const Field& field : ConcreteFields(schema, content)) {
    const auto found = content.fields.find(field.path);
    if (found == content.fields.end()) continue;
    const bool later = content.later.count(field.path) > 0;
    const Array& array = found->second;
    const std::string sha256 = later ? std::string(64, '0') : array.Sha256();
    if (Status written = later ? writer_.Make(field.path, array.type(), array.shape) : writer_.Write(field.path, array);
        !written) {
      return written;
    }
    if (field.path.rfind("/@", 0) != 0) {
      if (Status put = writer_.AttributeOf(field.path, "sha256", sha256); !put) return put;
    }
    if (later) growing_[field.path].shape = array;
    if (!later) lines_[field.path] = FieldLine(array, sha256);
    content.fields.erase(found);  // its bytes are in the file now
  }
  if (content.fields.empty()) return WriteExtra(content.extra);
  return Fail(ErrorCode::kInternal, "is not in the table of fields", Where(path_, content.fields.begin()->first));
}

Status ContentWriter::Append(const std::string& field, const Array& rows) {
  Growing& growing = growing_.at(field);
  if (rows.type() != growing.shape.type() || rows.rows() > growing.shape.rows() - growing.rows) {
    return Fail(ErrorCode::kInternal, "gets more rows than declared, or rows of another type", Where(path_, field));
  }
  rows.AddTo(growing.hasher);
  if (Status written = writer_.WriteRows(field, growing.rows, rows); !written) return written;
  growing.rows += rows.rows();
  return {};
}

Status ContentWriter::AppendExtra(const std::string& field, const ExtraField& rows) {
  auto& [shape, come] = growing_extra_.at(field);
  if (!shape.HasRowsLike(rows) || rows.rows() > shape.rows() - come) {
    return Fail(ErrorCode::kInternal, "gets more rows than declared, or rows of another type", Where(path_, field));
  }
  if (Status written = writer_.WriteExtraRows(field, come, rows); !written) return written;
  come += rows.rows();
  return {};
}

Status ContentWriter::Finish() {
  for (const auto& [field, growing] : growing_extra_) {
    if (growing.second == growing.first.rows()) continue;
    return Fail(ErrorCode::kInconsistent,
                "has " + std::to_string(growing.second) + " of " + std::to_string(growing.first.rows()) + " rows",
                Where(path_, field));
  }
  for (auto& [field, growing] : growing_) {
    if (growing.rows < growing.shape.rows()) {
      return Fail(ErrorCode::kInconsistent,
                  "has " + std::to_string(growing.rows) + " of " + std::to_string(growing.shape.rows()) + " rows",
                  Where(path_, field));
    }
    const std::string sha256 = growing.hasher.Hex();
    if (Status put = writer_.AttributeOf(field, "sha256", sha256); !put) return put;
    lines_[field] = FieldLine(growing.shape, sha256);
  }
  if (Status put = writer_.AttributeOf("/", "content_sha256", ContentSha256(lines_)); !put) return put;
  return writer_.Finish();
}

Status WriteContent(const Schema& schema, Content content, const std::filesystem::path& path) {
  auto writer = ContentWriter::Create(schema, std::move(content), path);
  return writer ? writer->Finish() : Forward(writer);
}

Expected<Content> ReadContent(const Schema& schema, const std::filesystem::path& path) {
  auto reader = Hdf5Reader::Open(path);
  if (!reader) return Forward(reader);
  return ReadContent(schema, *reader);
}

Expected<Content> ReadContent(const Schema& schema, const Hdf5Reader& reader) {
  Content content;
  const auto where = [&reader](const std::string& field) { return Where(reader.file(), field); };
  if (Status named = CheckSchemaName(schema, reader); !named) return Forward(named);
  Lines lines;
  for (const std::string& name : reader.GroupsBelow("/splits")) content.splits.insert(name);
  for (const Field& field : ConcreteFields(schema, content)) {
    if (!reader.Has(field.path)) continue;
    auto array = reader.Read(field.path, field.type);
    if (!array) return Forward(array);
    const std::string sha256 = array->Sha256();
    if (Status checked = CheckHash(reader, field.path, sha256); !checked) return Forward(checked);
    lines[field.path] = FieldLine(*array, sha256);
    content.fields[field.path] = std::move(*array);
  }
  if (Status checked = CheckContent(schema, content, ErrorCode::kMalformed, where); !checked) return Forward(checked);
  if (Status checked = CheckContentHash(reader, content, lines); !checked) return Forward(checked);
  return content;
}

Status CheckSkeleton(const Skeleton& skeleton, ErrorCode code, const std::filesystem::path& path,
                     const std::string& prefix) {
  const Status checked = skeleton.Check();
  if (checked) return {};
  return Fail(code, checked.error().what, Where(path, prefix + "/skeleton"), checked.error().hint);
}

}  // namespace mocurate::store
