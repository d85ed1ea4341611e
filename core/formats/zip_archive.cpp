#include "core/formats/zip_archive.h"

#include <zip.h>

#include <algorithm>
#include <cstdint>

#include "core/base/file.h"

namespace mocurate {
namespace {

constexpr std::size_t kPart = std::size_t{1} << 16;
constexpr std::uint16_t kFirstDay = (1u << 5) | 1u;  // 1980-01-01 in the date format of zip

std::string TextOf(zip_error_t& error) {
  std::string text = zip_error_strerror(&error);
  zip_error_fini(&error);
  return text;
}

}  // namespace

struct ZipArchive::Handle {
  zip_t* zip = nullptr;
  ~Handle() {
    if (zip != nullptr) zip_discard(zip);
  }
};

ZipArchive::ZipArchive(ZipArchive&&) noexcept = default;
ZipArchive& ZipArchive::operator=(ZipArchive&&) noexcept = default;
ZipArchive::~ZipArchive() = default;

Expected<ZipArchive> ZipArchive::Open(std::string_view bytes, const std::string& name, const ZipLimits& limits) {
  if (bytes.empty()) return EmptyFile(name);
  zip_error_t error;
  zip_error_init(&error);
  zip_source_t* source = zip_source_buffer_create(bytes.data(), bytes.size(), 0, &error);
  if (source == nullptr) return Fail(ErrorCode::kMalformed, "no zip archive: " + TextOf(error), name);
  zip_t* zip = zip_open_from_source(source, ZIP_RDONLY, &error);
  if (zip == nullptr) {
    zip_source_free(source);
    return Fail(ErrorCode::kMalformed, "no zip archive: " + TextOf(error), name, "the file is cut off: copy it again");
  }
  zip_error_fini(&error);
  ZipArchive archive;
  archive.handle_ = std::make_unique<Handle>();
  archive.handle_->zip = zip;
  archive.name_ = name;
  archive.limits_ = limits;
  archive.limits_.bytes = std::min<std::size_t>(limits.bytes, MostUnpacked(bytes.size()));
  const zip_int64_t count = zip_get_num_entries(zip, 0);
  if (count < 0 || static_cast<std::size_t>(count) > limits.members) {
    return Fail(ErrorCode::kUnsupported,
                std::to_string(count) + " members, at most " + std::to_string(limits.members) + " are read", name);
  }
  for (zip_int64_t i = 0; i < count; ++i) {
    const char* member = zip_get_name(zip, static_cast<zip_uint64_t>(i), ZIP_FL_ENC_GUESS);
    if (member == nullptr) {
      return Fail(ErrorCode::kMalformed, "member " + std::to_string(i) + " has no name", name);
    }
    archive.members_.push_back(DisplayPath(member));
  }
  return archive;
}

Expected<std::string> ZipArchive::Read(std::size_t index) {
  zip_t* zip = handle_->zip;
  const std::string where = name_ + ":" + (index < members_.size() ? members_[index] : std::to_string(index));
  zip_file_t* file = zip_fopen_index(zip, index, 0);
  if (file == nullptr) {
    zip_error_t* error = zip_get_error(zip);
    const bool encrypted = zip_error_code_zip(error) == ZIP_ER_NOPASSWD;
    const bool unknown = zip_error_code_zip(error) == ZIP_ER_COMPNOTSUPP;
    const std::string text = zip_error_strerror(error);
    return Fail(encrypted || unknown ? ErrorCode::kUnsupported : ErrorCode::kMalformed,
                "the member cannot be opened: " + text, where);
  }
  zip_stat_t declared;
  const bool has_size = zip_stat_index(zip, index, 0, &declared) == 0 && (declared.valid & ZIP_STAT_SIZE) != 0;
  if (!has_size || declared.size > limits_.bytes - unpacked_) {
    zip_fclose(file);
    return Fail(ErrorCode::kUnsupported,
                std::to_string(has_size ? declared.size : 0) + " bytes when unpacked, after " +
                    std::to_string(unpacked_) + " of other members; at most " + std::to_string(limits_.bytes) +
                    " of an archive of this size are read",
                where, "save the arrays that are needed in a file of their own");
  }
  std::string content;
  content.reserve(static_cast<std::size_t>(declared.size) + kPart);
  while (true) {
    const std::size_t before = content.size();
    content.resize(before + kPart);
    const zip_int64_t got = zip_fread(file, content.data() + before, kPart);
    if (got < 0) {
      const std::string text = zip_file_strerror(file);
      zip_fclose(file);
      return Fail(ErrorCode::kMalformed, "the member is damaged: " + text, where, "copy the file again");
    }
    content.resize(before + static_cast<std::size_t>(got));
    if (got == 0) break;
    if (content.size() > declared.size) {
      zip_fclose(file);
      return Fail(ErrorCode::kMalformed,
                  "unpacks to more than the " + std::to_string(declared.size) + " bytes that are declared", where,
                  "copy the file again");
    }
  }
  unpacked_ += content.size();
  if (const int closed = zip_fclose(file); closed != 0) {
    return Fail(ErrorCode::kMalformed, "the member is damaged (checksum)", where, "copy the file again");
  }
  return content;
}

Expected<std::string> WriteStoredZip(const std::vector<std::pair<std::string, std::string>>& members,
                                     const std::string& name) {
  std::uint64_t total = 0;
  for (const auto& [member, content] : members) total += content.size() + 2 * member.size() + 200;
  if (members.size() >= 65535 || total >= (std::uint64_t{1} << 32)) {
    return Fail(ErrorCode::kUnsupported, "an archive of 4 GiB or 65,535 members and more is not written", name);
  }
  zip_error_t error;
  zip_error_init(&error);
  zip_source_t* buffer = zip_source_buffer_create(nullptr, 0, 0, &error);
  if (buffer == nullptr) return Fail(ErrorCode::kCannotWrite, TextOf(error), name);
  zip_source_keep(buffer);
  zip_t* zip = zip_open_from_source(buffer, ZIP_CREATE | ZIP_TRUNCATE, &error);
  if (zip == nullptr) {
    zip_source_free(buffer);
    zip_source_free(buffer);
    return Fail(ErrorCode::kCannotWrite, TextOf(error), name);
  }
  const auto fail = [&] {
    const std::string text = zip_strerror(zip);
    zip_discard(zip);
    zip_source_free(buffer);
    return Fail(ErrorCode::kCannotWrite, "the archive cannot be made: " + text, name);
  };
  for (const auto& [member, content] : members) {
    zip_source_t* source = zip_source_buffer(zip, content.data(), content.size(), 0);
    if (source == nullptr) return fail();
    const zip_int64_t index = zip_file_add(zip, member.c_str(), source, ZIP_FL_ENC_UTF_8);
    if (index < 0) {
      zip_source_free(source);
      return fail();
    }
    const auto position = static_cast<zip_uint64_t>(index);
    if (zip_set_file_compression(zip, position, ZIP_CM_STORE, 0) != 0 ||
        zip_file_set_dostime(zip, position, 0, kFirstDay, 0) != 0) {
      return fail();
    }
  }
  if (zip_close(zip) != 0) return fail();
  Expected<std::string> archive = std::string();
  std::string& bytes = *archive;
  if (members.empty()) {
    bytes.assign("PK\x05\x06", 4).resize(22, '\0');  // libzip writes no archive without members
  } else if (zip_source_open(buffer) == 0) {
    bytes.resize(static_cast<std::size_t>(total));
    std::size_t size = 0;
    zip_int64_t got = 0;
    while (size < bytes.size() && (got = zip_source_read(buffer, bytes.data() + size, bytes.size() - size)) > 0) {
      size += static_cast<std::size_t>(got);
    }
    bytes.resize(size);
    zip_source_close(buffer);
  }
  zip_source_free(buffer);
  if (bytes.size() < 22) return Fail(ErrorCode::kCannotWrite, "the archive cannot be made", name);
  return archive;
}

}  // namespace mocurate
