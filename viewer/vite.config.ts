// Build: everything into one page that needs no network and opens from disk.
import { defineConfig } from "vite";
import { viteSingleFile } from "vite-plugin-singlefile";

export default defineConfig({
  plugins: [viteSingleFile({ removeViteModuleLoader: true })],
  build: {
    target: "es2022",
    outDir: process.env.SNUG_VIEWER_OUT || "dist",
    emptyOutDir: false,
    chunkSizeWarningLimit: 2000,
  },
});
