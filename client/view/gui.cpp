#include "client/view/gui.h"

#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_opengl3.h>
#include <imgui.h>

#include "common/error.h"

namespace terray {

Gui::Gui(Window& window) {
    IMGUI_CHECKVERSION();
    ImGui::CreateContext();
    ImGui::StyleColorsDark();
    ImGuiIO& io = ImGui::GetIO();
    io.IniFilename = nullptr;  // settings are the viewer's
    const auto scale = static_cast<float>(window.contentScale());
    ImFontConfig font;
    font.SizePixels = 13 * scale;
    io.Fonts->AddFontDefault(&font);
    ImGuiStyle& style = ImGui::GetStyle();
    style.WindowRounding = style.FrameRounding = 3;
    style.ScaleAllSizes(scale);
    if (!ImGui_ImplGlfw_InitForOpenGL(window.handle(), true) || !ImGui_ImplOpenGL3_Init("#version 450 core"))
        throw Error(ExitCode::graphics, "cannot set up Dear ImGui over the window's OpenGL 4.5 context");
}

Gui::~Gui() {
    ImGui_ImplOpenGL3_Shutdown();
    ImGui_ImplGlfw_Shutdown();
    ImGui::DestroyContext();
}

void Gui::begin() {
    ImGui_ImplOpenGL3_NewFrame();
    ImGui_ImplGlfw_NewFrame();
    ImGui::NewFrame();
}

void Gui::end() {
    ImGui::Render();
}

void Gui::draw() {
    if (ImDrawData* const data = ImGui::GetDrawData()) ImGui_ImplOpenGL3_RenderDrawData(data);
}

bool Gui::hasMouse() const {
    return ImGui::GetIO().WantCaptureMouse;
}

bool Gui::hasKeyboard() const {
    return ImGui::GetIO().WantTextInput;
}

}  // namespace terray
