// Build of the page of `snug ui`: three files, as its content policy allows no scripts or styles within the page.
import { defineConfig } from "vite";

export default defineConfig({
  build: {
    target: "es2022",
    outDir: process.env.SNUG_VIEWER_OUT || "dist",
    emptyOutDir: false,
    modulePreload: false,
    rollupOptions: {
      input: "workspace.html",
      output: { entryFileNames: "workspace.js", assetFileNames: "workspace[extname]" },
    },
  },
});
