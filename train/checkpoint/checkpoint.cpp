#include "train/checkpoint/checkpoint.h"

#include <algorithm>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>

#include "core/base/file.h"
#include "core/base/json_text.h"
#include "core/base/version.h"
#include "core/formats/safetensors.h"
#include "core/motion/skeleton.h"
#include "core/store/hdf5_file.h"

namespace mocurate {
namespace {

nlohmann::json ToJson(const Vector3d& v) { return {v.x(), v.y(), v.z()}; }

Vector3d FromJson(const nlohmann::json& json) {
  return {json.at(0).get<double>(), json.at(1).get<double>(), json.at(2).get<double>()};
}

Skeleton Parse(const nlohmann::json& json) {
  Skeleton skeleton;
  skeleton.name = json.at("name").get<std::string>();
  for (const nlohmann::json& item : json.at("joints")) {
    Joint joint;
    joint.name = item.at("name").get<std::string>();
    joint.parent = item.at("parent").get<int>();
    joint.rest_offset = FromJson(item.at("rest_offset"));
    joint.mirror = item.at("mirror").get<int>();
    joint.synonyms = item.at("synonyms").get<std::vector<std::string>>();
    joint.radius = item.at("radius").get<double>();
    if (item.contains("limits")) {
      joint.limits = JointLimits{FromJson(item.at("limits").at(0)), FromJson(item.at("limits").at(1))};
    }
    skeleton.joints.push_back(std::move(joint));
  }
  for (const nlohmann::json& item : json.at("landmarks")) {
    skeleton.landmarks.push_back(
        {item.at("name").get<std::string>(), item.at("joint").get<int>(), FromJson(item.at("offset"))});
  }
  if (json.contains("lie")) {
    LieChains lie;
    lie.chains = json.at("lie").at("chains").get<std::vector<std::vector<int>>>();
    for (const nlohmann::json& offset : json.at("lie").at("raw_offsets")) lie.raw_offsets.push_back(FromJson(offset));
    skeleton.lie = std::move(lie);
  }
  return skeleton;
}

/// All fields of a Skeleton, so that a checkpoint can generate motions without the skeleton's file.
nlohmann::json SkeletonToJson(const Skeleton& skeleton) {
  nlohmann::json json = {
      {"name", skeleton.name}, {"joints", nlohmann::json::array()}, {"landmarks", nlohmann::json::array()}};
  for (const Joint& joint : skeleton.joints) {
    nlohmann::json item = {
        {"name", joint.name},     {"parent", joint.parent},     {"rest_offset", ToJson(joint.rest_offset)},
        {"mirror", joint.mirror}, {"synonyms", joint.synonyms}, {"radius", joint.radius}};
    if (joint.limits) item["limits"] = {ToJson(joint.limits->min), ToJson(joint.limits->max)};
    json["joints"].push_back(std::move(item));
  }
  for (const Landmark& landmark : skeleton.landmarks) {
    json["landmarks"].push_back(
        {{"name", landmark.name}, {"joint", landmark.joint}, {"offset", ToJson(landmark.offset)}});
  }
  if (skeleton.lie) {
    nlohmann::json offsets = nlohmann::json::array();
    for (const Vector3d& offset : skeleton.lie->raw_offsets) offsets.push_back(ToJson(offset));
    json["lie"] = {{"chains", skeleton.lie->chains}, {"raw_offsets", std::move(offsets)}};
  }
  return json;
}

/// Error kMalformed (a field is missing or has another type), or that of Skeleton::Check; `where` is for messages.
Expected<SkeletonPtr> SkeletonFromJson(const nlohmann::json& json, const std::string& where) {
  Skeleton skeleton;
  try {
    skeleton = Parse(json);
  } catch (const nlohmann::json::exception& error) {
    return Fail(ErrorCode::kMalformed, std::string("the skeleton cannot be read: ") + error.what(), where);
  }
  if (Status check = skeleton.Check(); !check) return Forward(check);
  return std::make_shared<const Skeleton>(std::move(skeleton));
}

constexpr const char* kSchema = "mocurate-checkpoint/2";
constexpr const char* kFamily = "mocurate-checkpoint/";
constexpr const char* kSafetensorsEnding = ".safetensors";
constexpr const char* kAboutKey = "mocurate";
using Fields = std::map<std::string, store::Array>;
/// Where each field of a file comes from: one at a time is copied.
using Sources = std::map<std::string, std::function<store::Array()>>;

void PutParameters(const std::string& group, const ParameterList& parameters, Sources& sources) {
  for (const Parameter& parameter : parameters) {
    sources[group + "/" + parameter.name] = [&parameter] {
      return store::MakeArray({parameter.shape.begin(), parameter.shape.end()}, parameter.value);
    };
  }
}

nlohmann::json NamesOf(const ParameterList& parameters) {
  nlohmann::json names = nlohmann::json::array();
  for (const Parameter& parameter : parameters) names.push_back(parameter.name);
  return names;
}

/// The network of a file; states for continuing a training are empty where the file has none.
nlohmann::json AboutOf(const Checkpoint& checkpoint, nlohmann::json optimisers, nlohmann::json best) {
  nlohmann::json about = {{"kind", checkpoint.kind},
                          {"options", checkpoint.options},
                          {"facts", checkpoint.facts},
                          {"labels", checkpoint.labels},
                          {"dataset_sha256", checkpoint.dataset_sha256},
                          {"step", checkpoint.step},
                          {"finished", checkpoint.finished},
                          {"optimisers", std::move(optimisers)},
                          {"parameters", NamesOf(checkpoint.parameters)},
                          {"best", std::move(best)}};
  if (checkpoint.skeleton != nullptr) about["skeleton"] = SkeletonToJson(*checkpoint.skeleton);
  return about;
}

std::string ContentHash(const Fields& fields) {
  std::map<std::string, std::string> lines;
  for (const auto& [path, array] : fields) lines[path] = store::FieldLine(array, array.Sha256());
  return store::ContentSha256(lines);
}

/// A text attribute of the file; empty when there is none.
std::string AttributeText(const store::Hdf5Reader& reader, const char* name) {
  if (!reader.Has(name)) return {};
  const Expected<store::Array> array = reader.Read(name, store::FieldType::kText);
  return array && array->size() == 1 ? array->as<std::string>()[0] : std::string();
}

Expected<Fields> ReadFields(const std::filesystem::path& path) {
  Expected<store::Hdf5Reader> reader = store::Hdf5Reader::Open(path);
  if (!reader) return Forward(reader);
  const std::string where = DisplayPath(path);
  const std::string schema = AttributeText(*reader, "/@schema");
  if (schema != kSchema && schema.rfind(kFamily, 0) == 0) {
    return Fail(ErrorCode::kInconsistent, "the checkpoint is of version '" + schema + "'", where,
                std::string("this program reads ") + kSchema +
                    ": train again (mocurate run CONFIG --to train), or use the program that wrote the file");
  }
  if (schema != kSchema) {
    return Fail(ErrorCode::kInconsistent,
                schema.empty() ? std::string("the file is not a checkpoint")
                               : "the file is a '" + schema + "', not a checkpoint",
                where, std::string("use a checkpoint of schema ") + kSchema);
  }
  Fields fields;
  const Expected<std::vector<std::string>> paths = reader->AllPaths();
  if (!paths) return Forward(paths);
  for (const std::string& field : *paths) {
    const store::FieldType type = field == "/about" || field[1] == '@'    ? store::FieldType::kText
                                  : field.compare(0, 9, "/history/") == 0 ? store::FieldType::kFloat64
                                                                          : store::FieldType::kFloat32;
    Expected<store::Array> array = reader->Read(field, type);
    if (!array) return Forward(array);
    fields[field] = std::move(*array);
  }
  const std::string expected = AttributeText(*reader, "/@content_sha256");
  fields.erase("/@content_sha256");
  if (ContentHash(fields) != expected) {
    return Fail(ErrorCode::kMalformed, "the content does not match its content_sha256", where,
                "the file was changed or damaged; train again");
  }
  return fields;
}

/// A network in a safetensors file: its parameters, and its description in the metadata.
Expected<Fields> ReadExported(const std::filesystem::path& path) {
  const Expected<std::string> bytes = ReadFile(path);
  if (!bytes) return Forward(bytes);
  const std::string where = DisplayPath(path);
  const auto file = ParseSafetensors(*bytes, where);
  if (!file) return Forward(file);
  const auto about = file->metadata.find(kAboutKey);
  if (about == file->metadata.end()) {
    return Fail(ErrorCode::kInconsistent, "the file has tensors without a description of their network", where,
                std::string("add metadata '") + kAboutKey +
                    "', as written by `mocurate export CHECKPOINT -o FILE.safetensors`");
  }
  Fields fields;
  fields["/about"] = store::MakeText(about->second);
  for (const Safetensors::Tensor& tensor : file->tensors) {
    const std::vector<std::uint64_t> shape(tensor.shape.begin(), tensor.shape.end());
    fields["/parameters/" + tensor.name] = store::MakeArray(shape, tensor.values);
  }
  return fields;
}

Expected<ParameterList> TakeParameters(const nlohmann::json& names, const std::string& group, const std::string& where,
                                       Fields& fields) {
  ParameterList parameters;
  for (const nlohmann::json& name : names) {
    const auto found = fields.find(group + "/" + name.get<std::string>());
    if (found == fields.end()) {
      return Fail(ErrorCode::kMalformed, "parameter '" + name.get<std::string>() + "' is missing", where + ":" + group);
    }
    auto* values = std::get_if<std::vector<float>>(&found->second.values);
    if (values == nullptr) {
      return Fail(ErrorCode::kMalformed, "parameter '" + name.get<std::string>() + "' is not of type float32",
                  where + ":" + group);
    }
    Parameter parameter;
    parameter.name = name.get<std::string>();
    parameter.shape.assign(found->second.shape.begin(), found->second.shape.end());
    parameter.value = std::move(*values);
    parameters.push_back(std::move(parameter));
  }
  return parameters;
}

/// Checks the types of a network's facts.
Status CheckFacts(const nlohmann::json& facts, const std::string& where) {
  const auto numbers = [](const nlohmann::json& list) {
    return list.is_array() && std::all_of(list.begin(), list.end(), [](const auto& one) { return one.is_number(); });
  };
  const auto rows = [&](const nlohmann::json& list) {
    return list.is_array() && std::all_of(list.begin(), list.end(), numbers);
  };
  if (!facts.is_object()) return Fail(ErrorCode::kMalformed, "facts is not a mapping", where + ":/about");
  for (const auto& [name, value] : facts.items()) {
    const bool words = name == "words";
    const bool text = name == "rate" || name == "split" || name == "validation_rule" || name == "body";
    const bool fits = text                    ? value.is_string()
                      : words                 ? value.is_array() && std::all_of(value.begin(), value.end(),
                                                                                [](const auto& one) { return one.is_string(); })
                      : name == "bone_length" ? numbers(value)
                      : name == "first_pose" || name == "rest_offset" ? rows(value)
                                                                      : true;
    const bool number = name == "round" || name == "round_step" || name == "best_epoch" || name == "best_accuracy" ||
                        name == "best_loss" || name == "parameters";
    if (fits && (!number || value.is_number())) continue;
    return Fail(ErrorCode::kMalformed, "the fact has another type: " + value.dump().substr(0, 60),
                where + ":/about facts." + name, "use the unchanged file that mocurate wrote");
  }
  return {};
}

/// Empties `fields`.
Status FillFromAbout(const nlohmann::json& about, const std::string& where, Fields& fields, Checkpoint& checkpoint) {
  checkpoint.options = about.at("options");
  checkpoint.facts = about.at("facts");
  if (Status facts = CheckFacts(checkpoint.facts, where); !facts) return facts;
  checkpoint.labels = about.at("labels").get<std::vector<std::string>>();
  checkpoint.dataset_sha256 = about.at("dataset_sha256").get<std::string>();
  checkpoint.step = about.at("step").get<std::int64_t>();
  checkpoint.finished = about.at("finished").get<bool>();
  if (about.contains("skeleton")) {
    Expected<SkeletonPtr> skeleton = SkeletonFromJson(about.at("skeleton"), where + ":/about");
    if (!skeleton) return Forward(skeleton);
    checkpoint.skeleton = std::move(*skeleton);
  }
  Expected<ParameterList> parameters = TakeParameters(about.at("parameters"), "/parameters", where, fields);
  if (!parameters) return Forward(parameters);
  checkpoint.parameters = std::move(*parameters);
  Expected<ParameterList> best = TakeParameters(about.at("best"), "/best", where, fields);
  if (!best) return Forward(best);
  checkpoint.best = std::move(*best);
  for (const nlohmann::json& stored : about.at("optimisers")) {
    OptimiserState state;
    state.name = stored.at("name").get<std::string>();
    state.steps = stored.at("steps").get<std::int64_t>();
    const std::string group = "/optimisers/" + state.name;
    Expected<ParameterList> first = TakeParameters(stored.at("first"), group + "/first", where, fields);
    if (!first) return Forward(first);
    Expected<ParameterList> second = TakeParameters(stored.at("second"), group + "/second", where, fields);
    if (!second) return Forward(second);
    state.first = std::move(*first);
    state.second = std::move(*second);
    checkpoint.optimisers.push_back(std::move(state));
  }
  for (const auto& [path, array] : fields) {
    if (path.compare(0, 9, "/history/") == 0) checkpoint.history[path.substr(9)] = array.as<double>();
  }
  return {};
}

}  // namespace

Status WriteCheckpoint(const Checkpoint& checkpoint, const std::filesystem::path& path) {
  Sources sources;
  PutParameters("/parameters", checkpoint.parameters, sources);
  PutParameters("/best", checkpoint.best, sources);
  nlohmann::json optimisers = nlohmann::json::array();
  for (const OptimiserState& state : checkpoint.optimisers) {
    PutParameters("/optimisers/" + state.name + "/first", state.first, sources);
    PutParameters("/optimisers/" + state.name + "/second", state.second, sources);
    optimisers.push_back({{"name", state.name},
                          {"steps", state.steps},
                          {"first", NamesOf(state.first)},
                          {"second", NamesOf(state.second)}});
  }
  for (const auto& [name, column] : checkpoint.history) {
    const std::vector<double>& values = column;
    sources["/history/" + name] = [&values] { return store::MakeArray({values.size()}, values); };
  }
  const nlohmann::json about = AboutOf(checkpoint, std::move(optimisers), NamesOf(checkpoint.best));
  const auto text = [&sources](const char* field, const std::string& value) {
    sources[field] = [value] { return store::MakeText(value); };
  };
  text("/about", about.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace));
  text("/@schema", kSchema);
  text("/@kind", checkpoint.kind);
  text("/@created_by", std::string(CreatedBy()));
  std::map<std::string, std::string> lines;
  for (const auto& [field, source] : sources) {
    const store::Array array = source();
    lines[field] = store::FieldLine(array, array.Sha256());
  }
  text("/@content_sha256", store::ContentSha256(lines));
  Expected<store::Hdf5Writer> writer = store::Hdf5Writer::Create(path);
  if (!writer) return Forward(writer);
  for (const auto& [field, source] : sources) {
    if (Status written = writer->Write(field, source()); !written) return written;
  }
  return writer->Finish();
}

Status ExportSafetensors(const Checkpoint& checkpoint, const std::filesystem::path& path) {
  const nlohmann::json about = AboutOf(checkpoint, nlohmann::json::array(), nlohmann::json::array());
  Safetensors file;
  file.metadata = {{"format", "pt"}, {kAboutKey, about.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace)}};
  for (const Parameter& parameter : checkpoint.parameters) {
    file.tensors.push_back({parameter.name, parameter.shape, parameter.value});
  }
  return WriteFile(path, EncodeSafetensors(file));
}

Expected<Checkpoint> ReadCheckpoint(const std::filesystem::path& path, const std::string& kind) {
  Expected<Fields> fields = path.extension() == kSafetensorsEnding ? ReadExported(path) : ReadFields(path);
  if (!fields) return Forward(fields);
  const std::string where = DisplayPath(path);
  const auto text = fields->find("/about");
  const bool there = text != fields->end() && std::holds_alternative<std::vector<std::string>>(text->second.values);
  if (!there || text->second.size() != 1) return Fail(ErrorCode::kMalformed, "/about is missing", where);
  const Expected<nlohmann::json> about = ParseJson(text->second.as<std::string>()[0], where + ":/about");
  if (!about) return Forward(about);
  return GuardJson(where + ":/about", [&]() -> Expected<Checkpoint> {
    Checkpoint checkpoint;
    checkpoint.kind = about->at("kind").get<std::string>();
    if (!kind.empty() && checkpoint.kind != kind) {
      return Fail(ErrorCode::kInconsistent,
                  "the checkpoint holds a network of kind '" + checkpoint.kind + "', '" + kind + "' is needed", where,
                  "use a checkpoint of the required kind");
    }
    if (Status filled = FillFromAbout(*about, where, *fields, checkpoint); !filled) return Forward(filled);
    return checkpoint;
  });
}

bool IsCheckpoint(const std::filesystem::path& path) {
  if (path.extension() == kSafetensorsEnding) return true;
  const Expected<store::Hdf5Reader> reader = store::Hdf5Reader::Open(path);
  return reader && AttributeText(*reader, "/@schema").rfind(kFamily, 0) == 0;
}

Expected<nlohmann::json> DescribeCheckpoint(const std::filesystem::path& path) {
  const Expected<Checkpoint> checkpoint = ReadCheckpoint(path);
  if (!checkpoint) return Forward(checkpoint);
  std::size_t numbers = 0;
  for (const Parameter& parameter : checkpoint->parameters) numbers += parameter.value.size();
  nlohmann::json json = {{"schema", kSchema},
                         {"network", checkpoint->kind},
                         {"steps", checkpoint->step},
                         {"step", "iteration"},
                         {"finished", checkpoint->finished},
                         {"labels", checkpoint->labels},
                         {"skeleton", nullptr},
                         {"parameters", numbers},
                         {"dataset_sha256", checkpoint->dataset_sha256},
                         {"facts", checkpoint->facts},
                         {"options", checkpoint->options}};
  if (checkpoint->skeleton != nullptr) {
    json["skeleton"] = {{"name", checkpoint->skeleton->name}, {"joints", checkpoint->skeleton->joint_count()}};
  }
  return json;
}

}  // namespace mocurate
