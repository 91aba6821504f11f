#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "common/result.h"

namespace terray {

/// A JSON value (RFC 8259): small, strict, bounded; objects keep their order so that the same value is the same text.
///
/// Ours because the client must build with no more than GLM, epoxy, EGL, zstd and GeographicLib (preset bench-minimal).
/// Numbers are doubles; integers up to 2^53 are exact and print without a fraction. Text is UTF-8.
class Json {
  public:
    using Array = std::vector<Json>;
    using Object = std::vector<std::pair<std::string, Json>>;

    Json() = default;                                             ///< null
    Json(std::nullptr_t) {}                                       // NOLINT(google-explicit-constructor)
    Json(bool value) : value_(value) {}                           // NOLINT(google-explicit-constructor)
    Json(double value) : value_(value) {}                         // NOLINT(google-explicit-constructor)
    Json(int value) : value_(static_cast<double>(value)) {}       // NOLINT(google-explicit-constructor)
    Json(int64_t value) : value_(static_cast<double>(value)) {}   // NOLINT(google-explicit-constructor)
    Json(uint32_t value) : value_(static_cast<double>(value)) {}  // NOLINT(google-explicit-constructor)
    Json(uint64_t value) : value_(static_cast<double>(value)) {}  // NOLINT(google-explicit-constructor)
    Json(const char* value) : value_(std::string(value)) {}       // NOLINT(google-explicit-constructor)
    Json(std::string value) : value_(std::move(value)) {}         // NOLINT(google-explicit-constructor)
    Json(Array value) : value_(std::move(value)) {}               // NOLINT(google-explicit-constructor)
    Json(Object value) : value_(std::move(value)) {}              // NOLINT(google-explicit-constructor)

    bool operator==(const Json&) const = default;

    [[nodiscard]] bool isNull() const { return std::holds_alternative<std::nullptr_t>(value_); }
    [[nodiscard]] bool isBool() const { return std::holds_alternative<bool>(value_); }
    [[nodiscard]] bool isNumber() const { return std::holds_alternative<double>(value_); }
    [[nodiscard]] bool isString() const { return std::holds_alternative<std::string>(value_); }
    [[nodiscard]] bool isArray() const { return std::holds_alternative<Array>(value_); }
    [[nodiscard]] bool isObject() const { return std::holds_alternative<Object>(value_); }

    /// Reading as the wrong kind is misuse; ask is...() or use the lookups below.
    [[nodiscard]] bool boolean() const;
    [[nodiscard]] double number() const;
    [[nodiscard]] const std::string& string() const;
    [[nodiscard]] const Array& array() const;
    [[nodiscard]] const Object& object() const;

    /// The member of an object, or nullptr when this is no object or has none of that name.
    [[nodiscard]] const Json* find(std::string_view name) const;
    /// Member lookups that fail with a sentence naming the member: missing, or of another kind.
    [[nodiscard]] Result<double> numberAt(std::string_view name) const;
    [[nodiscard]] Result<std::string> stringAt(std::string_view name) const;
    [[nodiscard]] Result<bool> boolAt(std::string_view name) const;
    /// Sets or replaces a member; null becomes an object first.
    void set(std::string name, Json value);
    /// Appends to an array; null becomes an array first.
    void push(Json value);

    /// Parses a whole text. Refuses: anything after the value, duplicate names, depth over 64, invalid UTF-8, lone
    /// surrogates, numbers out of a double's range. The message says line and column. Allocates at most 64 bytes for
    /// each of the text: "0," becomes a value of 40 bytes in an array that grows by doubling.
    [[nodiscard]] static Result<Json> parse(std::string_view text);
    /// Text of this value; doubles in the shortest form that reads back exactly; NaN and infinities become null.
    /// @param indent  spaces per level, 0 for one line
    [[nodiscard]] std::string dump(int indent = 2) const;

  private:
    std::variant<std::nullptr_t, bool, double, std::string, Array, Object> value_ = nullptr;
};

}  // namespace terray
