import { defineConfig, type Plugin } from 'vite';

/** Puts script and style into the page itself: one file that opens from disk. */
function inline(): Plugin {
  return {
    name: 'inline',
    enforce: 'post',
    generateBundle(_, bundle) {
      const take = (file: string): string => {
        const entry = bundle[file];
        if (!entry) throw new Error(`the page asks for ${file}, which the build did not make`);
        delete bundle[file];
        return entry.type === 'chunk' ? entry.code : entry.source.toString();
      };
      for (const entry of Object.values(bundle)) {
        if (entry.type !== 'asset' || !entry.fileName.endsWith('.html')) continue;
        entry.source = entry.source
          .toString()
          .replace(/<script type="module"[^>]* src="\.\/([^"]+)"><\/script>/g, (_, file) => {
            // What would end a script element early inside one.
            const code = take(file).replaceAll('</script', '<\\/script').replaceAll('<!--', '<\\!--');
            return `<script type="module">${code}</script>`;
          })
          .replace(/<link rel="stylesheet"[^>]* href="\.\/([^"]+)">/g, (_, file) => {
            return `<style>${take(file)}</style>`;
          });
      }
      const left = Object.keys(bundle).filter((file) => !file.endsWith('.html'));
      if (left.length) throw new Error(`not in the page: ${left.join(', ')}`);
    },
  };
}

export default defineConfig({
  base: './',
  build: {
    target: 'es2022',
    modulePreload: false,
    assetsInlineLimit: Infinity,
    chunkSizeWarningLimit: 2000,
    rollupOptions: { output: { inlineDynamicImports: true } },
  },
  plugins: [inline()],
});
