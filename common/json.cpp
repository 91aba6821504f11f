#include "common/json.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

namespace terray {
namespace {

const char* kindOf(const Json& value) {
    if (value.isNull()) return "null";
    if (value.isBool()) return "a boolean";
    if (value.isNumber()) return "a number";
    if (value.isString()) return "a string";
    return value.isArray() ? "an array" : "an object";
}

/// The member when `isKind` holds for it, or a sentence about what is there instead.
Result<const Json*> member(const Json& object, std::string_view name, bool (Json::*isKind)() const, const char* kind) {
    const Json* found = object.find(name);
    if (found == nullptr) return Failure{"member \"" + std::string(name) + "\" is missing"};
    if (!(found->*isKind)())
        return Failure{"member \"" + std::string(name) + "\" is " + kindOf(*found) + ", expected " + kind};
    return found;
}

/// Writes a value as text; one object per dump().
class Writer {
  public:
    explicit Writer(int indent) : indent_(indent) {}

    void write(const Json& value, int depth) {
        if (value.isNull()) {
            text_ += "null";
        } else if (value.isBool()) {
            text_ += value.boolean() ? "true" : "false";
        } else if (value.isNumber()) {
            writeNumber(value.number());
        } else if (value.isString()) {
            writeString(value.string());
        } else if (value.isArray()) {
            writeArray(value.array(), depth);
        } else {
            writeObject(value.object(), depth);
        }
    }
    [[nodiscard]] std::string release() { return std::move(text_); }

  private:
    void writeNumber(double number) {
        if (!std::isfinite(number)) {
            text_ += "null";
            return;
        }
        // Whole numbers that a double holds exactly are written out, others in the shortest form that reads back.
        constexpr double kExactIntegers = 9007199254740992.0;  // 2^53
        std::array<char, 32> buffer{};
        const bool whole = std::abs(number) <= kExactIntegers && number == std::trunc(number);
        const auto result =
            whole && !(number == 0 && std::signbit(number))
                ? std::to_chars(buffer.data(), buffer.data() + buffer.size(), static_cast<int64_t>(number))
                : std::to_chars(buffer.data(), buffer.data() + buffer.size(), number);
        text_.append(buffer.data(), result.ptr);
    }
    void writeString(const std::string& string) {
        constexpr std::string_view kHex = "0123456789abcdef";
        text_ += '"';
        for (const char c : string) {
            const auto code = static_cast<unsigned char>(c);
            if (c == '"' || c == '\\') {
                text_ += '\\';
                text_ += c;
            } else if (c == '\n') {
                text_ += "\\n";
            } else if (c == '\t') {
                text_ += "\\t";
            } else if (code < 0x20) {
                text_ += "\\u00";
                text_ += kHex[code >> 4];
                text_ += kHex[code & 15];
            } else {
                text_ += c;
            }
        }
        text_ += '"';
    }
    /// Arrays of plain values (a position, a row of figures) stay on one line.
    void writeArray(const Json::Array& array, int depth) {
        const bool oneLine = std::none_of(array.begin(), array.end(),
                                          [](const Json& item) { return item.isArray() || item.isObject(); });
        text_ += '[';
        for (size_t i = 0; i < array.size(); ++i) {
            if (i > 0) text_ += oneLine && indent_ > 0 ? ", " : ",";
            if (!oneLine) newLine(depth + 1);
            write(array[i], depth + 1);
        }
        if (!oneLine) newLine(depth);
        text_ += ']';
    }
    void writeObject(const Json::Object& object, int depth) {
        text_ += '{';
        for (size_t i = 0; i < object.size(); ++i) {
            if (i > 0) text_ += ',';
            newLine(depth + 1);
            writeString(object[i].first);
            text_ += indent_ > 0 ? ": " : ":";
            write(object[i].second, depth + 1);
        }
        if (!object.empty()) newLine(depth);
        text_ += '}';
    }
    void newLine(int depth) {
        if (indent_ == 0) return;
        text_ += '\n';
        text_.append(static_cast<size_t>(indent_ * depth), ' ');
    }

    int indent_;
    std::string text_;
};

}  // namespace

bool Json::boolean() const {
    TERRAY_CHECK(isBool());
    return std::get<bool>(value_);
}

double Json::number() const {
    TERRAY_CHECK(isNumber());
    return std::get<double>(value_);
}

const std::string& Json::string() const {
    TERRAY_CHECK(isString());
    return std::get<std::string>(value_);
}

const Json::Array& Json::array() const {
    TERRAY_CHECK(isArray());
    return std::get<Array>(value_);
}

const Json::Object& Json::object() const {
    TERRAY_CHECK(isObject());
    return std::get<Object>(value_);
}

const Json* Json::find(std::string_view name) const {
    if (!isObject()) return nullptr;
    for (const auto& [key, value] : object())
        if (key == name) return &value;
    return nullptr;
}

Result<double> Json::numberAt(std::string_view name) const {
    const auto found = member(*this, name, &Json::isNumber, "a number");
    if (!found.ok()) return found.failure();
    return (*found)->number();
}

Result<std::string> Json::stringAt(std::string_view name) const {
    const auto found = member(*this, name, &Json::isString, "a string");
    if (!found.ok()) return found.failure();
    return (*found)->string();
}

Result<bool> Json::boolAt(std::string_view name) const {
    const auto found = member(*this, name, &Json::isBool, "a boolean");
    if (!found.ok()) return found.failure();
    return (*found)->boolean();
}

void Json::set(std::string name, Json value) {
    if (isNull()) value_ = Object{};
    TERRAY_CHECK(isObject());
    auto& members = std::get<Object>(value_);
    const auto same = std::find_if(members.begin(), members.end(), [&](const auto& m) { return m.first == name; });
    if (same != members.end()) {
        same->second = std::move(value);
    } else {
        members.emplace_back(std::move(name), std::move(value));
    }
}

void Json::push(Json value) {
    if (isNull()) value_ = Array{};
    TERRAY_CHECK(isArray());
    std::get<Array>(value_).push_back(std::move(value));
}

std::string Json::dump(int indent) const {
    Writer writer(indent);
    writer.write(*this, 0);
    return writer.release();
}

}  // namespace terray
