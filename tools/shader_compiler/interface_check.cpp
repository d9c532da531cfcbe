#include "interface_check.hpp"

#include "gl/shader_source.hpp"

#include <glslang/MachineIndependent/localintermediate.h>

#include <algorithm>
#include <map>

namespace lamina::tools {
namespace {

struct Variable {
    std::string name; ///< Of the block, for an interface block.
    std::string type;
    std::string place; ///< Of its first use: the tree does not keep that of the declaration.
    int location = -1;
    bool isUsed = false;
};

/// Where each variable is first used in the functions of a stage.
class UseFinder : public glslang::TIntermTraverser {
public:
    bool visitAggregate(glslang::TVisit, glslang::TIntermAggregate* node) override {
        return node->getOp() != glslang::EOpLinkerObjects;
    }
    void visitSymbol(glslang::TIntermSymbol* symbol) override {
        firstUse.emplace(symbol->getId(), symbol->getLoc());
    }
    std::map<long long, glslang::TSourceLoc> firstUse;
};

std::string placeOf(const glslang::TSourceLoc& location, std::span<const std::string> files) {
    return gl::describePlace(static_cast<std::size_t>(location.string),
                             static_cast<std::size_t>(location.line), files);
}

/// As in GLSL, without qualifiers. Members are spelled out: they must match too.
std::string spell(const glslang::TType& type) {
    std::string text;
    if (type.isStruct()) {
        text = type.getTypeName().c_str() + std::string(" {");
        for (const glslang::TTypeLoc& member : *type.getStruct())
            text += " " + spell(*member.type) + " " + member.type->getFieldName().c_str() + ";";
        text += " }";
        if (type.isArray())
            text += "[" + std::to_string(type.getOuterArraySize()) + "]";
        return text;
    }
    text = type.getCompleteString(true, false, false, true).c_str();
    return text.substr(std::min(text.find_first_not_of(' '), text.size()));
}

std::string typeName(const glslang::TType& type, EShLanguage stage) {
    if (type.isArray() && type.getQualifier().isArrayedIo(stage))
        return spell(glslang::TType(type, 0));
    return spell(type);
}

/// The user's variables of one storage class in a stage.
std::vector<Variable> variables(const CompiledStage& stage, glslang::TStorageQualifier storage) {
    UseFinder uses;
    stage.tree->getTreeRoot()->traverse(&uses);
    std::vector<Variable> found;
    for (TIntermNode* node : stage.tree->findLinkerObjects()->getSequence()) {
        const glslang::TIntermSymbol* symbol = node->getAsSymbolNode();
        if (!symbol || symbol->getQualifier().storage != storage)
            continue;
        const glslang::TType& type = symbol->getType();
        const bool isBlock = type.getBasicType() == glslang::EbtBlock;
        const std::string name = isBlock ? type.getTypeName().c_str() : symbol->getName().c_str();
        if (type.isBuiltIn() || name.starts_with("gl_"))
            continue;
        Variable variable{name, typeName(type, stage.tree->getStage()), stage.files[0]};
        if (type.getQualifier().hasLocation())
            variable.location = static_cast<int>(type.getQualifier().layoutLocation);
        const auto use = uses.firstUse.find(symbol->getId());
        variable.isUsed = use != uses.firstUse.end();
        if (variable.isUsed)
            variable.place = placeOf(use->second, stage.files);
        found.push_back(std::move(variable));
    }
    return found;
}

const Variable* findFeeding(const std::vector<Variable>& outputs, const Variable& input) {
    for (const Variable& output : outputs) {
        if (input.location >= 0 ? output.location == input.location : output.name == input.name)
            return &output;
    }
    return nullptr;
}

} // namespace

std::vector<std::string> checkInterface(const CompiledStage& producer,
                                        const CompiledStage& consumer) {
    const std::vector<Variable> outputs = variables(producer, glslang::EvqVaryingOut);
    std::vector<std::string> errors;
    for (const Variable& input : variables(consumer, glslang::EvqVaryingIn)) {
        if (!input.isUsed)
            continue;
        const std::string start =
            input.place + ": error: input " + input.name + " is " + input.type;
        const Variable* output = findFeeding(outputs, input);
        if (!output)
            errors.push_back(start + ", but " + producer.files[0] + " has no output " +
                             (input.location >= 0 ? "at location " + std::to_string(input.location)
                                                  : "of this name"));
        else if (output->type != input.type)
            errors.push_back(start + ", but the output " + output->name + " at " + output->place +
                             " is " + output->type);
    }
    return errors;
}

} // namespace lamina::tools
