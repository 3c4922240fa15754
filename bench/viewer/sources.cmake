# What runs in the page, natively for tests and as WebAssembly: relative to this folder.
set(page_sources data_views.cpp groom_tools.cpp map_brush.cpp page_request.cpp page_settings.cpp page_view.cpp replay_viewer.cpp viewer.cpp)
