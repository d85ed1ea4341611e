#include <nlohmann/json.hpp>

#include "core/base/file.h"
#include "core/base/options.h"

namespace mocurate {
namespace {

/// Writes every option it visits; open groups and lists are on a stack.
class JsonWriter final : public OptionVisitor {
 public:
  JsonWriter() { open_.push_back({"", nlohmann::json::object()}); }
  nlohmann::json Result() { return std::move(open_.front().json); }

  void Bool(const char* name, bool& value, const char*) override { Put(name, value); }
  void Integer(const char* name, std::int64_t& value, Range, const char*) override { Put(name, value); }
  void Number(const char* name, double& value, Unit, Range, const char*) override { Put(name, value); }
  void OptionalNumber(const char* name, std::optional<double>& value, Unit, Range, const char*) override {
    Put(name, value ? nlohmann::json(*value) : nlohmann::json());
  }
  void Text(const char* name, std::string& value, const char*) override { Put(name, value); }
  void Path(const char* name, std::filesystem::path& value, const char*) override { Put(name, DisplayPath(value)); }
  void Numbers(const char* name, std::vector<double>& value, Unit, Range, const char*) override { Put(name, value); }
  void Texts(const char* name, std::vector<std::string>& value, const char*) override { Put(name, value); }
  void TextMap(const char* name, std::map<std::string, std::string>& value, const char*) override { Put(name, value); }
  void ChoiceIndex(const char* name, std::size_t& index, const std::vector<std::string>& names, const char*) override {
    Put(name, names[index]);
  }

  void BeginGroup(const char* name, const char*) override { open_.push_back({name, nlohmann::json::object()}); }
  void EndGroup() override { Close(); }
  std::size_t BeginList(const char* name, std::size_t size, const char*) override {
    open_.push_back({name, nlohmann::json::array()});
    return size;
  }
  void BeginElement(std::size_t) override { open_.push_back({"", nlohmann::json::object()}); }
  void EndElement() override { Close(); }
  void EndList() override { Close(); }

 private:
  struct Open {
    std::string name;
    nlohmann::json json;
  };

  void Put(const char* name, nlohmann::json value) { open_.back().json[name] = std::move(value); }

  void Close() {
    Open closed = std::move(open_.back());
    open_.pop_back();
    if (open_.back().json.is_array()) {
      open_.back().json.push_back(std::move(closed.json));
    } else {
      open_.back().json[closed.name] = std::move(closed.json);
    }
  }

  std::vector<Open> open_;
};

}  // namespace

namespace internal {

nlohmann::json ToJson(Declaration declaration) {
  JsonWriter writer;
  declaration.declare(declaration.options, writer);
  return writer.Result();
}

}  // namespace internal
}  // namespace mocurate
