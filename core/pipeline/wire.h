#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>

#include "core/base/error.h"
#include "core/pipeline/stage.h"

namespace mocurate {

/// Text of a JSON value whose strings may hold any bytes (file names): bytes that are not UTF-8, and '%', are written
/// as %NN, so nothing is lost. Keys are sorted, numbers independent of the locale: equal values give equal text.
std::string CanonicalText(const nlohmann::json& value);

/// Inverse of CanonicalText. Errors of ParseJson.
Expected<nlohmann::json> FromCanonicalText(std::string_view text, const std::string& name = {});

nlohmann::json ToJson(const Error& error);
nlohmann::json ToJson(const StageOutcome& outcome);

/// Error kMalformed when a part is missing or has another type.
Expected<Error> ErrorFromJson(const nlohmann::json& json);
Expected<StageOutcome> OutcomeFromJson(const nlohmann::json& json);
Expected<StageRequest> RequestFromJson(const nlohmann::json& json);

/// One message as it travels: length (4 bytes, little endian), then its canonical text.
std::string Frame(const nlohmann::json& message);

/// Removes the first complete message from `buffer`; empty while it is incomplete. Error kMalformed when the bytes are
/// not a message.
Expected<std::optional<nlohmann::json>> TakeMessage(std::string& buffer);

}  // namespace mocurate
