#include "core/store/content_file.h"

#include "core/base/file.h"

namespace mocurate::store {
namespace {

using Lines = std::map<std::string, std::string>;

/// The splits' names become paths: no empty ones, no slash.
Status CheckSplitNames(const Content& content, const std::filesystem::path& path) {
  for (const std::string& name : content.splits) {
    if (!name.empty() && name != "." && name.find('/') == std::string::npos && name.find('\0') == std::string::npos) {
      continue;
    }
    return Fail(ErrorCode::kInconsistent, "'" + name + "' is no name for a split", Where(path, "/splits"),
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
  if (name->as<std::string>()[0] == schema.name) return {};
  return Fail(ErrorCode::kMalformed,
              "the file is '" + name->as<std::string>()[0] + "'; '" + schema.name + "' was expected",
              Where(reader.file(), "/@schema"), "give the file of the right kind");
}

Status WriteContent(const Schema& schema, Content content, const std::filesystem::path& path) {
  content.PutText("/@schema", schema.name);
  content.PutText("/@units", "m s rad");
  content.PutText("/@content_sha256", std::string(64, '0'));
  if (Status checked = CheckSplitNames(content, path); !checked) return checked;
  const auto where = [&path](const std::string& field) { return Where(path, field); };
  if (Status checked = CheckContent(schema, content, ErrorCode::kInconsistent, where); !checked) return checked;

  Lines lines;
  Lines hashes;
  for (const auto& [field, array] : content.fields) {
    hashes[field] = array.Sha256();
    lines[field] = FieldLine(array, hashes[field]);
  }
  content.PutText("/@content_sha256", ContentSha256(lines));
  auto writer = Hdf5Writer::Create();
  if (!writer) return Forward(writer);
  for (const Field& field : ConcreteFields(schema, content)) {
    const auto found = content.fields.find(field.path);
    if (found == content.fields.end()) continue;
    if (Status written = writer->Write(field.path, found->second); !written) return written;
    if (field.path.rfind("/@", 0) != 0) {
      if (Status put = writer->AttributeOf(field.path, "sha256", hashes[field.path]); !put) return put;
    }
    content.fields.erase(found);  // its bytes are in the image now
  }
  if (!content.fields.empty()) {
    return Fail(ErrorCode::kInternal, "is not in the table of fields", Where(path, content.fields.begin()->first));
  }
  return writer->Finish([&path](std::string_view bytes) { return WriteFile(path, bytes); });
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
