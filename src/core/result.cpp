#include <lamina/core/result.hpp>

namespace lamina {

std::string_view name(ErrorCode code) {
    switch (code) {
    case ErrorCode::InvalidArgument:
        return "InvalidArgument";
    case ErrorCode::InvalidMesh:
        return "InvalidMesh";
    case ErrorCode::InvalidFile:
        return "InvalidFile";
    case ErrorCode::UnknownFormat:
        return "UnknownFormat";
    case ErrorCode::NotFound:
        return "NotFound";
    case ErrorCode::InputOutput:
        return "InputOutput";
    case ErrorCode::OutOfMemory:
        return "OutOfMemory";
    case ErrorCode::DeviceLimit:
        return "DeviceLimit";
    case ErrorCode::UnsupportedDevice:
        return "UnsupportedDevice";
    case ErrorCode::NoContext:
        return "NoContext";
    case ErrorCode::ShaderError:
        return "ShaderError";
    case ErrorCode::Unsupported:
        return "Unsupported";
    case ErrorCode::Cancelled:
        return "Cancelled";
    }
    return "Unknown";
}

} // namespace lamina
